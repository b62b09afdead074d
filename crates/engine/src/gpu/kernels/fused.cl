// From one prediction to the next in one kernel: contact, correct, predict. It reads one half of the state and writes the other, so
// that neighbours see what they should.
#if !GEAR && !LEDGER
kernel fused
{
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(i, step.items) {
            if (i < step.particles) {
                const Quad x = LOAD(place, i), v = LOAD(motion, i);
#if MOMENTS
                const Quad w = LOAD(spin, i);
#else
                const Quad w = QUAD(0.0, 0.0, 0.0, 0.0);
#endif
                Body body = body_at(i, x, v, w, DERIVATIVES);
#if CONSTRAINED || !ONE_PAIR || HEAT
                const u32 mine = kind[i];
#else
                const u32 mine = 0;
#endif
                const Constraint held = HELD(mine, step.time);
                Heated heated;
                LOOK_UP(heated);
                heated.specific_heats = specific_heats;
                Heat heat = heat_at(TEMPERATURE_AT(i, w));
                Vec3 f, m, bond_force = zero(), bond_moment = zero();
#if BONDS
                body.orientation = quaternion(LOAD(orientation, i));
#if BONDS_APART
                sum_reactions(step, i, bond_number, reaction, bond_flow, &heat, &bond_force, &bond_moment);
#else
                sum_bonds(step, i, body.sphere, place, motion, spin, orientation, bonded_place, kind, rank, interactions,
                          joints, beams, slice, other, bond_other, bond_start, bond_strength, broken, released, heated, &heat,
                          &bond_force, &bond_moment);
#endif
#endif
                u32 wrong = sum_contacts(step, i, body.sphere, MATERIAL_OF(mine), place, motion, spin, kind, interactions,
                                         slice, other, displacement, walls, wall_place, heated, &heat, bond_force,
                                         bond_moment, &f, &m);
#if APPLIED_FORCES
                f = plus(f, held.force);
#endif
#if LOCAL_DAMPING
                damp_locally(step, body.sphere, held, zero(), zero(), &f, &m);
#endif
                correct_body(step, &body, f, m, held);
                const Constraint next_held = HELD(mine, step.middle_time);
                predict_body(step, &body, f, m, next_held, next_held);
                real growth = 0.0;
#if HEAT
                body.temperature = heat.temperature;
                const real rate = heat_rate_of(step, i, MATERIAL_OF(mine), &heat, heated);
                wrong |= warm(step, i, MATERIAL_OF(mine), rate, heated, &body.sphere, &body.temperature);
#if !MOMENTS
                next_temperature[i] = body.temperature;
#endif
#endif
#if EXPANDS
                growth = body.sphere.radius - listed_radius[i];
#endif
                wrong |= judge(step, i, growth, &body.sphere.position, image, reference);
                if (wrong)
                    raise_flags(step, status, wrong);
                next_place[i] = quad(body.sphere.position, body.sphere.radius);
                keep_motion(i, body, next_motion, next_spin, DERIVATIVES);
#if BONDS
                next_orientation[i] = quad(body.orientation.vector, body.orientation.scalar);
#endif
            }
            if (i < step.walls)
                move_wall(step, i, walls, wall_place, next_wall_place, wall_reference, status);
        }
    }
    hand_on(step, status, flags, 1u);
}
#endif
