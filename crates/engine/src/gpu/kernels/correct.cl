// Stage `correct`: velocities at the end of the step.

DEVICE void correct_verlet(const Step step, Sphere *body, const Vec3 force, const Vec3 moment, const Constraint held)
{
    Vec3 kicked;
    kick(body->velocity, force, body->mass, step.half_dt, &kicked);
#if CONSTRAINED
    kicked = prescribe(kicked, held.velocity, held.components);
#endif
    body->velocity = kicked;
#if MOMENTS
    real inertia;
    sphere_inertia(body->mass, body->radius, &inertia);
    Vec3 turned;
    kick(body->angular_velocity, moment, inertia, step.half_dt, &turned);
#if CONSTRAINED
    turned = prescribe(turned, held.angular_velocity, held.components >> 3);
#endif
    body->angular_velocity = turned;
#endif
}

kernel correct
{
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(i, step.particles) {
            const Quad x = place[i], v = motion[i];
#if MOMENTS
            Sphere body = sphere(x, v, spin[i]);
            const Vec3 torque = vector(moment[i]);
#else
            Sphere body = sphere(x, v, QUAD(0.0, 0.0, 0.0, 0.0));
            const Vec3 torque = zero();
#endif
#if CONSTRAINED
            const Constraint held = constraints[CONSTRAINT_OF(kind[i])];
#else
            Constraint held;
#endif
#if GEAR
            Trajectory predicted, corrected;
            predicted.position = body.position;
            predicted.velocity = body.velocity;
            for (u32 d = 0; d < 4u; ++d)
                predicted.derivatives[d] = planes_at(step, derivatives, 3u * d, i);
            gear_correct(predicted, vector(force[i]), body.mass, step.dt, &corrected);
#if CONSTRAINED
            corrected.position = prescribe(corrected.position, predicted.position, held.components);
            corrected.velocity = prescribe(corrected.velocity, held.velocity, held.components);
            for (u32 d = 0; d < 4u; ++d)
                corrected.derivatives[d] = prescribe(corrected.derivatives[d], zero(), held.components);
#endif
            place[i] = quad(corrected.position, x.w);
            motion[i] = quad(corrected.velocity, v.w);
            for (u32 d = 0; d < 4u; ++d)
                set_planes(step, derivatives, 3u * d, i, corrected.derivatives[d]);
#if MOMENTS
            real inertia;
            sphere_inertia(body.mass, body.radius, &inertia);
            Vec3 turned;
            kick(body.angular_velocity, torque, inertia, step.dt, &turned);
#if CONSTRAINED
            turned = prescribe(turned, held.angular_velocity, held.components >> 3);
#endif
            spin[i] = quad(turned, 0.0);
#endif
#else
            correct_verlet(step, &body, vector(force[i]), torque, held);
            motion[i] = quad(body.velocity, v.w);
#if MOMENTS
            spin[i] = quad(body.angular_velocity, 0.0);
#endif
#endif
        }
    }
    hand_on(step, status, flags, 0u);
}
