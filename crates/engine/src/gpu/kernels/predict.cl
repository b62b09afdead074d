// Stage `predict`: particles and walls move to the end of the step.

// To the end of the step, under the forces of its beginning. `held` is of the middle of the step, `at_end` of its end.
DEVICE void predict_body(const Step step, Body *body, const Vec3 force, const Vec3 moment, const Constraint held,
                         const Constraint at_end)
{
#if GEAR
    Trajectory now, next;
    now.position = body->sphere.position;
    now.velocity = body->sphere.velocity;
#if CONSTRAINED
    now.velocity = prescribe(now.velocity, held.velocity, held.components);
#endif
    for (u32 d = 0; d < 4u; ++d)
        now.derivatives[d] = body->derivatives[d];
    gear_predict(now, step.dt, &next);
#if CONSTRAINED
    next.velocity = prescribe(next.velocity, at_end.velocity, at_end.components);
#endif
    body->sphere.position = next.position;
    body->sphere.velocity = next.velocity;
    for (u32 d = 0; d < 4u; ++d)
        body->derivatives[d] = next.derivatives[d];
#else
    kick_velocity(&body->sphere, force, held, step.half_dt);
    Vec3 drifted;
    drift(body->sphere.position, body->sphere.velocity, step.dt, &drifted);
    body->sphere.position = drifted;
    kick_angular_velocity(&body->sphere, moment, held, step.half_dt);
#endif
#if BONDS
    // Under Verlet by the angular velocity of the middle of the step, under Gear by that of its beginning.
    Quaternion turned;
    turn_orientation(body->orientation, body->sphere.angular_velocity, step.dt, &turned);
    body->orientation = turned;
#endif
}

#if PERIODIC
// Brings one coordinate back in. How far round is counted, and the reference goes along.
DEVICE void bring_back(const Step step, const u32 k, const u32 i, const real length, const real low, const real high,
                       real *x, GLOBAL i32 *RESTRICT image, GLOBAL u64 *RESTRICT reference)
{
    if (length > 0.0 && (*x >= high || *x < low)) {
        const i32 round = *x >= high ? 1 : -1;
        *x -= (real)round * length;
        image[(size_t)k * step.particles + i] += round;
        const u64 mask = (u64)TICK_MASK << k * TICK_BITS;
        const u64 turn = (u64)(i64)(length * step.ticks_per_metre + 0.5) << k * TICK_BITS;
        const u64 ticks = reference[i];
        reference[i] = (ticks & ~mask) | ((round > 0 ? ticks - turn : ticks + turn) & mask);
    }
}
#endif

// Brings a centre that left through a face that repeats back in, and says what is wrong with it and with the list. What a
// particle has grown since the list was made counts like a way.
DEVICE u32 judge(const Step step, const u32 i, const real growth, Vec3 *position, GLOBAL i32 *RESTRICT image,
                 GLOBAL u64 *RESTRICT reference)
{
#if PERIODIC
    const Vec3 length = step.period.length, low = step.domain_min, high = step.domain_max;
    bring_back(step, 0, i, length.x, low.x, high.x, &position->x, image, reference);
    bring_back(step, 1, i, length.y, low.y, high.y, &position->y, image, reference);
    bring_back(step, 2, i, length.z, low.z, high.z, &position->z, image, reference);
#endif
    const Vec3 x = *position;
    u32 flags = 0;
    const int inside = x.x >= step.domain_min.x && x.x <= step.domain_max.x && x.y >= step.domain_min.y
                    && x.y <= step.domain_max.y && x.z >= step.domain_min.z && x.z <= step.domain_max.z;
    if (!inside)
        flags |= ASTRAY;
    const u64 squared = squared_ticks(reference[i], ticks_of(x, step.domain_min, step.ticks_per_metre));
#if EXPANDS
    const real way = sqrt((real)squared) + (growth > 0.0 ? growth * step.ticks_per_metre : 0.0);
    if (way * way >= (real)step.ticks_allowed)
        flags |= LIST_DUE;
#else
    if (squared >= step.ticks_allowed)
        flags |= LIST_DUE;
#endif
    return flags;
}

// How far the farthest went in one step, and how much it shrank, matters to the list of a ledger once it is more than
// half the skin.
DEVICE void note_way(const Step step, GLOBAL u32 *status, const Vec3 way, const real shrinkage)
{
#if EXPANDS
    const real farthest = sqrt(inner(way, way)) + (shrinkage > 0.0 ? shrinkage : 0.0);
    const real squared = farthest * farthest;
#else
    const real squared = inner(way, way);
#endif
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
    note_way(step, status, minus(moved, start), 0.0);
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
                Body body = body_at(i, place[i], motion[i], SPIN(i), DERIVATIVES);
#if BONDS
                body.orientation = quaternion(orientation[i]);
#endif
                const Quad whole = force[i];
                const Vec3 f = vector(whole), m = MOMENT(i);
                // Between two steps nobody looks at the neighbours: the end of one and the start of the next are one.
                if (step.corrects)
                    correct_body(step, &body, f, m, HELD(kind[i], step.time));
                const Sphere before = body.sphere;
                predict_body(step, &body, f, m, HELD(kind[i], step.middle_time), HELD(kind[i], step.next_time));
#if LEDGER && !GEAR
                kick_by_half[i] = quad(minus(body.sphere.velocity, before.velocity), 0.0);
#if MOMENTS
                twist_by_half[i] = quad(minus(body.sphere.angular_velocity, before.angular_velocity), 0.0);
#endif
#endif
                u32 wrong = 0;
                real growth = 0.0;
#if HEAT
                Heated heated;
                heated.temperature = temperature;
                heated.reference_radius = reference_radius;
                heated.thermals = thermals;
                heated.specific_heats = specific_heats;
                heated.exposure = exposure;
                heated.exposures = exposures;
                heated.pieces = pieces;
                body.temperature = TEMPERATURE_AT(i, SPIN(i));
                wrong = warm(step, i, MATERIAL_OF(kind[i]), whole.w, heated, &body.sphere,
#if LEDGER
                             heat_accounts,
#if EXPANSION_WORK
                             work_per_kelvin, warming,
#endif
#endif
                             &body.temperature);
#if !MOMENTS
                temperature[i] = body.temperature;
#endif
#endif
#if EXPANDS
                growth = body.sphere.radius - listed_radius[i];
#endif
                note_way(step, status, minus(body.sphere.position, before.position), before.radius - body.sphere.radius);
                wrong |= judge(step, i, growth, &body.sphere.position, image, reference);
                if (wrong)
                    raise_flags(step, status, wrong);
                place[i] = quad(body.sphere.position, body.sphere.radius);
                keep_motion(i, body, motion, spin, DERIVATIVES);
#if BONDS
                orientation[i] = quad(body.orientation.vector, body.orientation.scalar);
#endif
            }
            if (i < step.walls)
                move_wall(step, i, walls, wall_place, wall_place, wall_reference, status);
        }
    }
    hand_on(step, status, flags, 0u);
}
