// Stage `predict`: particles and walls move to the end of the step.

// Velocity Verlet's half kick and drift; angular velocity by half kicks.
DEVICE void predict_verlet(const Step step, Sphere *body, const Vec3 force, const Vec3 moment, const Constraint held)
{
    Vec3 kicked;
    kick(body->velocity, force, body->mass, step.half_dt, &kicked);
#if CONSTRAINED
    kicked = prescribe(kicked, held.velocity, held.components);
#endif
    body->velocity = kicked;
    Vec3 drifted;
    drift(body->position, kicked, step.dt, &drifted);
    body->position = drifted;
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

// Brings a centre that left through a face that repeats back in, and says what is wrong with it and with the list.
DEVICE u32 judge(const Step step, const u32 i, Vec3 *position, GLOBAL i32 *RESTRICT image,
                 GLOBAL const real *RESTRICT reference)
{
    Vec3 x = *position;
#if PERIODIC
    const Vec3 length = step.period.length;
    if (length.x > 0.0) {
        if (x.x >= step.domain_max.x) { x.x -= length.x; image[PLANE(0, i)] += 1; }
        else if (x.x < step.domain_min.x) { x.x += length.x; image[PLANE(0, i)] -= 1; }
    }
    if (length.y > 0.0) {
        if (x.y >= step.domain_max.y) { x.y -= length.y; image[PLANE(1, i)] += 1; }
        else if (x.y < step.domain_min.y) { x.y += length.y; image[PLANE(1, i)] -= 1; }
    }
    if (length.z > 0.0) {
        if (x.z >= step.domain_max.z) { x.z -= length.z; image[PLANE(2, i)] += 1; }
        else if (x.z < step.domain_min.z) { x.z += length.z; image[PLANE(2, i)] -= 1; }
    }
    *position = x;
#endif
    u32 flags = 0;
    const int inside = x.x >= step.domain_min.x && x.x <= step.domain_max.x && x.y >= step.domain_min.y
                    && x.y <= step.domain_max.y && x.z >= step.domain_min.z && x.z <= step.domain_max.z;
    if (!inside)
        flags |= ASTRAY;
    const Vec3 way = offset_between(step, planes_at(step, reference, 0, i), x);
    if (inner(way, way) > step.half_skin_squared)
        flags |= LIST_DUE;
    return flags;
}

// How far the farthest went in one step matters to the list of a ledger once it is more than half the skin.
DEVICE void note_way(const Step step, GLOBAL u32 *status, const Vec3 way)
{
    const real squared = inner(way, way);
    if (squared > step.noted_way_squared) {
        const u32 bits = FLOAT_BITS((float)(squared * 1.000001));
        if (bits > status[FARTHEST_STEP])
            ATOMIC_MAX(status + FARTHEST_STEP, bits);
    }
}

// The wall of this index moves on in a straight line.
DEVICE void move_wall(const Step step, const u32 w, GLOBAL const Wall *RESTRICT walls, GLOBAL const Quad *from,
                      GLOBAL Quad *to, GLOBAL const Quad *RESTRICT wall_reference, GLOBAL u32 *status)
{
    const Vec3 start = vector(from[w]);
    Vec3 moved;
    drift(start, walls[w].velocity, step.dt, &moved);
    to[w] = quad(moved, 0.0);
    note_way(step, status, minus(moved, start));
    const Vec3 way = minus(moved, vector(wall_reference[w]));
    if (inner(way, way) > step.half_skin_squared)
        raise_flags(step, status, LIST_DUE);
}

kernel predict
{
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(i, step.items) {
            if (i < step.particles) {
                const Quad x = place[i], v = motion[i];
#if MOMENTS
                const Quad w = spin[i];
                const Vec3 torque = vector(moment[i]);
#else
                const Quad w = QUAD(0.0, 0.0, 0.0, 0.0);
                const Vec3 torque = zero();
#endif
                Sphere body = sphere(x, v, w);
#if CONSTRAINED
                const Constraint held = constraints[CONSTRAINT_OF(kind[i])];
#else
                Constraint held;
#endif
#if GEAR
                Trajectory now, next;
                now.position = body.position;
#if CONSTRAINED
                now.velocity = prescribe(body.velocity, held.velocity, held.components);
#else
                now.velocity = body.velocity;
#endif
                for (u32 d = 0; d < 4u; ++d)
                    now.derivatives[d] = planes_at(step, derivatives, 3u * d, i);
                gear_predict(now, step.dt, &next);
                body.position = next.position;
#if CONSTRAINED
                body.velocity = prescribe(next.velocity, held.velocity, held.components);
#else
                body.velocity = next.velocity;
#endif
                for (u32 d = 0; d < 4u; ++d)
                    set_planes(step, derivatives, 3u * d, i, next.derivatives[d]);
#else
                predict_verlet(step, &body, vector(force[i]), torque, held);
#if LEDGER
                kick_by_half[i] = quad(minus(body.velocity, vector(v)), 0.0);
#if MOMENTS
                twist_by_half[i] = quad(minus(body.angular_velocity, vector(w)), 0.0);
#endif
#endif
#endif
                note_way(step, status, minus(body.position, vector(x)));
                const u32 wrong = judge(step, i, &body.position, image, reference);
                if (wrong)
                    raise_flags(step, status, wrong);
                place[i] = quad(body.position, x.w);
                motion[i] = quad(body.velocity, v.w);
#if MOMENTS && !GEAR
                spin[i] = quad(body.angular_velocity, 0.0);
#endif
            }
            if (i < step.walls)
                move_wall(step, i, walls, wall_place, wall_place, wall_reference, status);
        }
    }
    hand_on(step, status, flags, 0u);
}
