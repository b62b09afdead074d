// All stages between two predictions in one kernel: contact, correct, and the prediction of the next step. It reads one
// half of the state and writes the other, so that neighbours see what they should.

#if !GEAR && !LEDGER
kernel fused
{
    const u32 flags = halted(step, status);
    if (!flags) {
        FOR_EACH(i, step.items) {
            if (i < step.particles) {
                const Quad x = LOAD(place, i), v = LOAD(motion, i);
#if MOMENTS
                Sphere body = sphere(x, v, LOAD(spin, i));
#else
                Sphere body = sphere(x, v, QUAD(0.0, 0.0, 0.0, 0.0));
#endif
#if CONSTRAINED || !ONE_PAIR
                const u32 mine = kind[i];
#else
                const u32 mine = 0;
#endif
#if CONSTRAINED
                const Constraint held = constraints[CONSTRAINT_OF(mine)];
#else
                Constraint held;
#endif
                Vec3 f, m;
                u32 wrong = sum_contacts(step, i, body, MATERIAL_OF(mine), place, motion, spin, kind, interactions, slice,
                                         other, displacement, walls, wall_place, &f, &m);
                correct_verlet(step, &body, f, m, held);
                predict_verlet(step, &body, f, m, held);
                wrong |= judge(step, i, &body.position, image, reference);
                if (wrong)
                    raise_flags(step, status, wrong);
                next_place[i] = quad(body.position, x.w);
                next_motion[i] = quad(body.velocity, v.w);
#if MOMENTS
                next_spin[i] = quad(body.angular_velocity, 0.0);
#endif
            }
            if (i < step.walls)
                move_wall(step, i, walls, wall_place, next_wall_place, wall_reference, status);
        }
    }
    hand_on(step, status, flags, 1u);
}
#endif
