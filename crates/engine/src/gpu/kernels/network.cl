// Heat alone: what conducts while nothing moves, with the sums of the processor: along a row in its order; over all
// particles exactly, see `exact.cl`. Particles stand in the order of ids. A group has a chunk.

// Entry k of row r stands at slice[r / SIDE] + k * SIDE + r % SIDE.

// What conducts to particles, row by row: contacts, bonds, walls; the ends are counted along the row.
typedef struct {
    GLOBAL const u64 *slice;
    GLOBAL const u32 *contacts_end;
    GLOBAL const u32 *bonds_end;
    GLOBAL const u32 *walls_end;
    GLOBAL const u32 *other;
    GLOBAL const real *conductance;
} Rows;

#define LOOK_UP(rows)                  \
    Rows rows;                         \
    rows.slice = slice;                \
    rows.contacts_end = contacts_end;  \
    rows.bonds_end = bonds_end;        \
    rows.walls_end = walls_end;        \
    rows.other = other;                \
    rows.conductance = conductance

// What stands around particles.
typedef struct {
    GLOBAL const u32 *exposure;
    GLOBAL const Surface *surfaces;
    GLOBAL const Exchange *exchanges;
    GLOBAL const real *around;
} Environment;

#define LOOK_OUT(environment)           \
    Environment environment;            \
    environment.exposure = exposure;    \
    environment.surfaces = surfaces;    \
    environment.exchanges = exchanges;  \
    environment.around = around

DEVICE u64 place_of(const Rows rows, const u32 i, const u32 entry)
{
    return rows.slice[i / SIDE] + (u64)entry * SIDE + i % SIDE;
}

// Into a particle of one temperature, through a part of its row.
DEVICE real flow_through(const Rows rows, const u32 i, const u32 from, const u32 end, const real mine,
                         GLOBAL const real *others)
{
    real sum = 0.0;
    u64 place = place_of(rows, i, from);
    for (u32 entry = from; entry < end; ++entry, place += SIDE) {
        real rate;
        heat_flow(rows.conductance[place], mine, others[rows.other[place]], &rate);
        sum += rate;
    }
    return sum;
}

// The conductances of a part of a row together.
DEVICE real conductance_of(const Rows rows, const u32 i, const u32 from, const u32 end)
{
    real sum = 0.0;
    u64 place = place_of(rows, i, from);
    for (u32 entry = from; entry < end; ++entry, place += SIDE)
        sum += rows.conductance[place];
    return sum;
}

// Into a particle, through contacts and bonds.
DEVICE real conducted(const Rows rows, const u32 i, GLOBAL const real *temperature)
{
    const u32 contacts = rows.contacts_end[i];
    const real mine = temperature[i];
    const real through_contacts = flow_through(rows, i, 0u, contacts, mine, temperature);
    return through_contacts + flow_through(rows, i, contacts, rows.bonds_end[i], mine, temperature);
}

// Conductances of contacts and bonds together.
DEVICE real joined(const Rows rows, const u32 i)
{
    const u32 contacts = rows.contacts_end[i];
    const real of_contacts = conductance_of(rows, i, 0u, contacts);
    return of_contacts + conductance_of(rows, i, contacts, rows.bonds_end[i]);
}

// What is outside of the surface of an exchange.
DEVICE Outside outside_of(const Conduction conduction, const Environment environment, const u32 exchange)
{
    GLOBAL const real *values = environment.around + conduction.walls + conduction.exposures + 3u * exchange;
    Outside outside;
    outside.flux = values[0];
    outside.fluid = values[1];
    outside.surroundings = values[2];
    return outside;
}

// Into a particle, from walls and through its surface.
DEVICE real foreign_heat(const Conduction conduction, const Rows rows, const Environment environment, const u32 i, const real mine)
{
    real sum = flow_through(rows, i, rows.bonds_end[i], rows.walls_end[i], mine, environment.around);
    const Surface surface = environment.surfaces[environment.exposure[i]];
    for (u32 k = surface.first_exchange; k < surface.end_exchange; ++k) {
        real rate;
        surface_heat(environment.exchanges[k], mine, outside_of(conduction, environment, k), &rate);
        sum += rate;
    }
    return sum;
}

// How much less comes in from walls and through the surface per kelvin.
DEVICE real sensitivity(const Conduction conduction, const Rows rows, const Environment environment, const u32 i, const real mine)
{
    real sum = conductance_of(rows, i, rows.bonds_end[i], rows.walls_end[i]);
    const Surface surface = environment.surfaces[environment.exposure[i]];
    for (u32 k = surface.first_exchange; k < surface.end_exchange; ++k) {
        real more;
        surface_sensitivity(environment.exchanges[k], mine, outside_of(conduction, environment, k), &more);
        sum += more;
    }
    return sum;
}

// Whether a part of the step before this one left no temperature.
DEVICE u32 is_over(const Conduction conduction, const u32 halted)
{
    return halted != 0u && halted < conduction.part;
}

DEVICE u32 particles_of_chunk(const Conduction conduction, const u32 chunk)
{
    const u32 left = conduction.particles - chunk * CHUNK;
    return left < CHUNK ? left : CHUNK;
}

kernel rate
{
    LOOK_UP(rows);
    LOOK_OUT(environment);
    FOR_EACH(i, conduction.particles) {
        if (is_over(conduction, halted[0]))
            continue;
        const real from_outside = foreign_heat(conduction, rows, environment, i, temperature[i]);
        total[i] = conducted(rows, i, temperature) + from_outside;
        foreign[i] = from_outside;
    }
}

kernel least_step
{
    LOCAL real terms[CHUNK];
    LOOK_UP(rows);
    LOOK_OUT(environment);
    const u32 count = particles_of_chunk(conduction, GROUP_INDEX);
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) {
        const u32 i = GROUP_INDEX * CHUNK + k;
        real step = INFINITY;
        if (!surfaces[exposure[i]].prescribed)
            longest_step(capacity[i], joined(rows, i) + sensitivity(conduction, rows, environment, i, temperature[i]), &step);
        terms[k] = step;
    }
    BARRIER;
    if (LOCAL_INDEX == 0u) {
        real least = INFINITY;
        for (u32 k = 0; k < count; ++k)
            least = terms[k] < least ? terms[k] : least;
        partial[GROUP_INDEX] = least;
    }
}

kernel warm
{
    FOR_EACH(i, conduction.particles) {
        if (is_over(conduction, halted[0]))
            continue;
        const u32 exposed = exposure[i];
        real free;
        warmed(temperature[i], total[i], capacity[i], conduction.step, &free);
        const real now = surfaces[exposed].prescribed ? around[conduction.walls + exposed] : free;
        if (conduction.booked) {
            real came = heat_in[i], went = heat_out[i];
            const real flown = foreign[i] * conduction.step, given = capacity[i] * (now - free);
            if (flown > 0.0)
                came += flown;
            else
                went -= flown;
            if (given > 0.0)
                came += given;
            else
                went -= given;
            heat_in[i] = came;
            heat_out[i] = went;
        }
        temperature[i] = now;
        if (!(now > 0.0 && now < INFINITY))
            ATOMIC_MAX(halted, conduction.part);
    }
}

kernel begin
{
    ROOM_FOR_TERMS(2u);
    const u32 count = particles_of_chunk(conduction, GROUP_INDEX);
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) {
        const u32 i = GROUP_INDEX * CHUNK + k;
        const u32 exposed = exposure[i];
        const real now = temperature[i];
        end[i] = surfaces[exposed].prescribed ? around[conduction.walls + exposed] : now;
        real square;
        thermal_square(capacity[i], now, &square);
        terms[k] = square;
        terms[CHUNK + k] = capacity[i];
    }
    ADD_TERMS(2u, count, conduction.copies, sums)
}

kernel assemble
{
    ROOM_FOR_TERMS(2u);
    LOOK_UP(rows);
    LOOK_OUT(environment);
    const u32 count = particles_of_chunk(conduction, GROUP_INDEX);
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) {
        const u32 i = GROUP_INDEX * CHUNK + k;
        const real mine = end[i];
        const real from_outside = foreign_heat(conduction, rows, environment, i, mine);
        const real less = sensitivity(conduction, rows, environment, i, mine);
        real holds, square, error;
        implicit_held(capacity[i], conduction.step, less, &holds);
        const real all = holds + joined(rows, i);
        const real missing = surfaces[exposure[i]].prescribed ? 0.0 : conducted(rows, i, end) + from_outside;
        residual_squares(missing, all, capacity[i], conduction.step, &square, &error);
        foreign[i] = from_outside;
        loss[i] = less;
        held[i] = holds;
        diagonal[i] = all;
        residual[i] = missing;
        change[i] = 0.0;
        way[i] = missing / all;
        terms[k] = square;
        terms[CHUNK + k] = error;
    }
    ADD_TERMS(2u, count, conduction.copies, sums)
}

kernel multiply
{
    ROOM_FOR_TERMS(1u);
    LOOK_UP(rows);
    const u32 count = scalars[0].done ? 0u : particles_of_chunk(conduction, GROUP_INDEX);
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) {
        const u32 i = GROUP_INDEX * CHUNK + k;
        real made = 0.0;
        if (!surfaces[exposure[i]].prescribed)
            implicit_balance(held[i], way[i], conducted(rows, i, way), &made);
        product[i] = made;
        terms[k] = way[i] * made;
    }
    ADD_TERMS(1u, count, conduction.copies, sums)
}

kernel advance
{
    ROOM_FOR_TERMS(2u);
    const u32 count = scalars[0].done ? 0u : particles_of_chunk(conduction, GROUP_INDEX);
    const real part = scalars[0].part;
    for (u32 k = LOCAL_INDEX; k < count; k += GROUP) {
        const u32 i = GROUP_INDEX * CHUNK + k;
        const real missing = residual[i] + -part * product[i];
        real square, error;
        residual_squares(missing, diagonal[i], capacity[i], conduction.step, &square, &error);
        change[i] += part * way[i];
        residual[i] = missing;
        terms[k] = square;
        terms[CHUNK + k] = error;
    }
    ADD_TERMS(2u, count, conduction.copies, sums)
}

kernel turn
{
    FOR_EACH(i, conduction.particles) {
        if (scalars[0].done)
            continue;
        way[i] = residual[i] / diagonal[i] + scalars[0].turn * way[i];
    }
}

kernel finish
{
    FOR_EACH(i, conduction.particles) {
        real at_end;
        foreign_at_end(foreign[i], loss[i], change[i], &at_end);
        end[i] += change[i];
        foreign[i] = at_end;
    }
}

kernel conduct
{
    LOOK_UP(rows);
    FOR_EACH(i, conduction.particles)
        total[i] = conducted(rows, i, end) + foreign[i];
}

kernel take_content
{
    TAKE_SUMS(2u, conduction.copies, sums);
    if (LOCAL_INDEX == 0u) {
        Scalars now;
        now.square = now.error = now.part = now.turn = 0.0;
        now.limit = conduction.tolerance_squared * totals[0];
        now.capacity = totals[1];
        now.iterations = now.done = now.stuck = now.padding = 0u;
        scalars[0] = now;
    }
}

kernel take_work
{
    TAKE_SUMS(1u, conduction.copies, sums);
    if (LOCAL_INDEX == 0u && !scalars[0].done) {
        const real work = totals[0];
        scalars[0].part = scalars[0].square / work;
        if (scalars[0].iterations == conduction.most_iterations || !(work > 0.0))
            scalars[0].done = scalars[0].stuck = 1u;
    }
}

kernel take_squares
{
    TAKE_SUMS(2u, conduction.copies, sums);
    if (LOCAL_INDEX == 0u && !scalars[0].done) {
        scalars[0].turn = totals[0] / scalars[0].square;
        scalars[0].square = totals[0];
        scalars[0].error = totals[1];
        scalars[0].iterations += counted;
        scalars[0].done = !(totals[1] > scalars[0].limit);
    }
}
