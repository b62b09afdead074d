// Stage `correct`: velocities at the end of the step.

DEVICE void correct_body(const Step step, Body *body, const Vec3 force, const Vec3 moment, const Constraint held)
{
#if GEAR
    Trajectory predicted, corrected;
    predicted.position = body->sphere.position;
    predicted.velocity = body->sphere.velocity;
    for (u32 d = 0; d < 4u; ++d)
        predicted.derivatives[d] = body->derivatives[d];
    gear_correct(predicted, force, body->sphere.mass, step.dt, &corrected);
#if CONSTRAINED
    corrected.position = prescribe(corrected.position, predicted.position, held.components);
    corrected.velocity = prescribe(corrected.velocity, held.velocity, held.components);
    for (u32 d = 0; d < 4u; ++d)
        corrected.derivatives[d] = prescribe(corrected.derivatives[d], zero(), held.components);
#endif
    body->sphere.position = corrected.position;
    body->sphere.velocity = corrected.velocity;
    for (u32 d = 0; d < 4u; ++d)
        body->derivatives[d] = corrected.derivatives[d];
    // Euler's rule for rotation is the paper's.
    kick_angular_velocity(&body->sphere, moment, held, step.dt);
#else
    kick_velocity(&body->sphere, force, held, step.half_dt);
    kick_angular_velocity(&body->sphere, moment, held, step.half_dt);
#endif
}

kernel correct
{
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(i, step.particles) {
            Body body = body_at(i, place[i], motion[i], SPIN(i), DERIVATIVES);
            correct_body(step, &body, vector(force[i]), MOMENT(i), HELD(kind[i], step.time));
#if GEAR
            place[i] = quad(body.sphere.position, body.sphere.radius);
#endif
            keep_motion(i, body, motion, spin, DERIVATIVES);
        }
    }
    hand_on(step, status, flags, 0u);
}
