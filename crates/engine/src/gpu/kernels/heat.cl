// Heat: what flows into a particle, and the temperature and radius that follow. Parts of the stages bond, contact and
// predict; the order of the sums is that of the CPU: contacts along the row, the sum of the bonds, then what is foreign,
// which is walls and the surface.

// What flows is looked up here. A kernel sets what it has; without heat nobody looks.
typedef struct {
    GLOBAL const real *temperature;
    GLOBAL const real *reference_radius;
    GLOBAL const Thermal *thermals;
    GLOBAL const Conductor *conductors;
    GLOBAL const Link *links;
    GLOBAL const u32 *exposure;
    GLOBAL const Tabled *conductivities;
    GLOBAL const Tabled *specific_heats;
    GLOBAL const Factors *factors;
    GLOBAL const Exposure *exposures;
    GLOBAL const Exchanging *exchanges;
    GLOBAL const Piece *pieces;
    GLOBAL const u32 *bond_other;
} Heated;

// From the parameters of a kernel that evaluates contacts, bonds and surfaces.
#define LOOK_UP(heated)                          \
    heated.temperature = temperature;            \
    heated.reference_radius = reference_radius;  \
    heated.thermals = thermals;                  \
    heated.conductors = conductors;              \
    heated.links = links;                        \
    heated.conductivities = conductivities;      \
    heated.factors = factors;                    \
    heated.exposure = exposure;                  \
    heated.exposures = exposures;                \
    heated.exchanges = exchanges;                \
    heated.pieces = pieces;                      \
    heated.bond_other = bond_other

// Where particles turn, their temperatures are the fourth numbers of their spins, which are loaded anyway; else they stand
// apart.
#if !HEAT
#define TEMPERATURE_AT(i, spin)  0.0
#elif MOMENTS
#define TEMPERATURE_AT(i, spin)  (spin).w
#else
#define TEMPERATURE_AT(i, spin)  LOAD_REAL(heated.temperature, i)
#endif

// The temperature of a particle and its heat rate, as far as it is summed; and, where they are asked for, the heat that it
// gets from friction and dashpots, and what its energy in springs gains per kelvin, each in parts that are added in the end.
typedef struct {
    real temperature;
    real contacts;
    real bonds;
    real foreign;
    real made_at_contacts;
    real made_at_walls;
    real made_by_bonds;
    real pressure_of_contacts;
    real pressure_of_walls;
    real work_of_bonds;
} Heat;

DEVICE Heat heat_at(const real temperature)
{
    Heat heat;
    heat.temperature = temperature;
    heat.contacts = heat.bonds = heat.foreign = 0.0;
    heat.made_at_contacts = heat.made_at_walls = heat.made_by_bonds = 0.0;
    heat.pressure_of_contacts = heat.pressure_of_walls = heat.work_of_bonds = 0.0;
    return heat;
}

// The radius that a particle's bonds have.
DEVICE Sphere as_bonded(Sphere sphere, const u32 i, const Heated heated)
{
#if EXPANDS
    sphere.radius = heated.reference_radius[i];
#endif
    return sphere;
}

#if HEAT
#if ONE_CONDUCTOR
#define CONDUCTOR(first, second)  step.conductor
#else
#define CONDUCTOR(first, second)  heated.conductors[(first) * step.materials + (second)]
#endif

// The value of a course at a time.
DEVICE real course_at(GLOBAL const Piece *pieces, const u32 first, const u32 end, const real time)
{
    real value = NAN;
    for (u32 k = first; k < end; ++k) {
        const Piece piece = pieces[k];
        if (piece.from <= time && time < piece.until)
            ramp_line(piece.start, piece.start_value, piece.end, piece.end_value, time, &value);
    }
    return value;
}

// What is outside of a surface at a time; what is absent is zero.
DEVICE Outside outside_of(const Exchanging exchanging, const real time, const Heated heated)
{
    Outside outside;
    const u32 flux = exchanging.flux_piece, fluid = exchanging.fluid_piece;
    const u32 surroundings = exchanging.surroundings_piece, end = exchanging.end_piece;
    outside.flux = flux < fluid ? course_at(heated.pieces, flux, fluid, time) : 0.0;
    outside.fluid = fluid < surroundings ? course_at(heated.pieces, fluid, surroundings, time) : 0.0;
    outside.surroundings = surroundings < end ? course_at(heated.pieces, surroundings, end, time) : 0.0;
    return outside;
}

#if CONDUCTIVITY_TABLES || SPECIFIC_HEAT_TABLES || BOND_TABLES
// The piece of a table that holds at a temperature.
DEVICE u32 piece_at(GLOBAL const Piece *pieces, const u32 first, const u32 end, const real temperature)
{
    u32 k = first;
    while (k + 1u < end && !(temperature < pieces[k].until))
        ++k;
    return k;
}

// The value of a table at a temperature.
DEVICE real property_at(GLOBAL const Piece *pieces, const u32 first, const u32 end, const real temperature)
{
    const Piece piece = pieces[piece_at(pieces, first, end, temperature)];
    real value;
    ramp_line(piece.start, piece.start_value, piece.end, piece.end_value, temperature, &value);
    return value;
}
#endif

// A conductance at the temperatures of both ends.
DEVICE real tempered(const real conductance, const u32 first, const u32 second, const real mine, const real theirs,
                     const Heated heated)
{
#if CONDUCTIVITY_TABLES
    const Tabled my_table = heated.conductivities[first], their_table = heated.conductivities[second];
    real mean, found;
    mean_temperature(mine, theirs, &mean);
    tempered_conductance(conductance, property_at(heated.pieces, my_table.first_piece, my_table.end_piece, mean),
                         property_at(heated.pieces, their_table.first_piece, their_table.end_piece, mean), &found);
    return found;
#else
    return conductance;
#endif
}

#if SPECIFIC_HEAT_TABLES
// The temperature of a body that took in heat per mass: from piece to piece of its specific heat.
DEVICE real warmed_along(GLOBAL const Piece *pieces, const Tabled table, const real temperature, const real heat)
{
    real place = temperature, left = heat;
    u32 k = piece_at(pieces, table.first_piece, table.end_piece, temperature);
    for (;;) {
        const Piece piece = pieces[k];
        const real bound = left > 0.0 ? piece.until : piece.from;
        if (fabs(bound) < INFINITY) {
            real room;
            heat_along(piece.start, piece.start_value, piece.end, piece.end_value, place, bound, &room);
            if (fabs(left) > fabs(room)) {
                left -= room;
                place = bound;
                k = left > 0.0 ? k + 1u : k - 1u;
                continue;
            }
        }
        real rise;
        heat_rise(piece.start, piece.start_value, piece.end, piece.end_value, place, left, &rise);
        return place + rise;
    }
}

#if LEDGER
// Heat per mass between two temperatures that ascend.
DEVICE real heat_up_to(GLOBAL const Piece *pieces, const Tabled table, const real from, const real to)
{
    real place = from, heat = 0.0;
    for (u32 k = piece_at(pieces, table.first_piece, table.end_piece, from); k < table.end_piece; ++k) {
        const Piece piece = pieces[k];
        const int ends = to < piece.until;
        real more;
        heat_along(piece.start, piece.start_value, piece.end, piece.end_value, place, ends ? to : piece.until, &more);
        heat += more;
        if (ends)
            return heat;
        place = piece.until;
    }
    return NAN;
}

DEVICE real heat_between(GLOBAL const Piece *pieces, const Tabled table, const real from, const real to)
{
    return to < from ? -heat_up_to(pieces, table, to, from) : heat_up_to(pieces, table, from, to);
}
#endif
#endif

// What a bond is to heat, wherever its particles lie. The spheres have the radii that bonds have.
DEVICE Link link_anywhere(const Step step, const u32 i, const u32 j, const Sphere body, const Sphere partner,
                          GLOBAL const u32 *RESTRICT kind, const Heated heated)
{
#if ONE_LINK
    return step.link;
#else
    const u32 mine = MATERIAL_OF(kind[i]), theirs = MATERIAL_OF(kind[j]);
#if ALIKE_LINKS
    return heated.links[mine * step.materials + theirs];
#else
    real radii[2], expansions[2];
    radii[0] = body.radius;
    radii[1] = partner.radius;
    expansions[0] = heated.thermals[mine].expansion;
    expansions[1] = heated.thermals[theirs].expansion;
    Link link;
    link_between(CONDUCTOR(mine, theirs), radii, expansions, &link);
    return link;
#endif
#endif
}

// What a bond is to heat.
DEVICE Link link_of(const Step step, const u32 i, const u32 j, const Sphere body, const Sphere partner,
                    GLOBAL const u32 *RESTRICT kind, const Heated heated)
{
    Link link = link_anywhere(step, i, j, body, partner, kind, heated);
#if BOUNDED
    if (heated.exposures[heated.exposure[i]].sides & heated.exposures[heated.exposure[j]].sides) {
        Link within;
        link_within_side(link, &within);
        link = within;
    }
#endif
    return link;
}

// Into a particle, through a bond.
DEVICE real through_bond(const Link link, const real bonded_length, const u32 material, const u32 other,
                         const real mine, const real theirs, const Heated heated)
{
    real conductance, rate;
    link_conductance(link, bonded_length, &conductance);
    heat_flow(tempered(conductance, material, other, mine, theirs, heated), mine, theirs, &rate);
    return rate;
}

// The strain that a bond takes up without force.
DEVICE real strain_of(const Step step, const Link link, const real mine, const real theirs)
{
    real strain;
    free_strain(link, mine - step.reference_temperature, theirs - step.reference_temperature, &strain);
    return strain;
}

// Into a particle, from a partner that it touches.
DEVICE real from_partner(const Step step, const Sphere body, const real radius, const Touch touch, const u32 material,
                         const u32 other, const real theirs, const Heat heat, const Heated heated)
{
    const real mine = heat.temperature;
    real conductance, rate;
    between_spheres(CONDUCTOR(material, other), body.radius, radius, touch, &conductance);
    heat_flow(tempered(conductance, material, other, mine, theirs, heated), mine, theirs, &rate);
    return rate;
}

// Into a particle, from a wall that has a temperature.
DEVICE real from_wall(const Step step, const Wall wall, const Sphere body, const Touch touch, const u32 material,
                      const Heat heat, const Heated heated)
{
    const real mine = heat.temperature;
    const real theirs = course_at(heated.pieces, wall.first_piece, wall.end_piece, step.heat_time);
    real conductance, rate;
    at_wall(CONDUCTOR(material, wall.material), body.radius, touch, &conductance);
    heat_flow(tempered(conductance, material, wall.material, mine, theirs, heated), mine, theirs, &rate);
    return rate;
}

#if LEDGER
// Heat that came in, or left if it is negative, J.
DEVICE void book_heat(const u32 i, const real heat, GLOBAL Quad *RESTRICT heat_accounts)
{
    if (heat > 0.0)
        heat_accounts[i].x += heat;
    else if (heat < 0.0)
        heat_accounts[i].y -= heat;
}

#if EXPANSION_WORK
// Half of the work that expansion does in a step, J.
DEVICE void book_expansion(const u32 i, const real work_per_kelvin, const real warming,
                           GLOBAL Quad *RESTRICT heat_accounts)
{
    real work;
    half_step_of_work(work_per_kelvin, warming, &work);
    heat_accounts[i].w += work;
}
#endif
#endif

#if MAKES_HEAT
// Heat that one of two bodies gets from what both lost, J.
DEVICE real half_of_heat(const Step step, const real friction, const real damping)
{
    real energy;
    dissipated_heat(step.dissipation, friction, damping, &energy);
    return 0.5 * energy;
}

// Heat that a particle got from friction and dashpots, J.
DEVICE real made_heat(const Heat heat)
{
    return heat.made_at_contacts + heat.made_at_walls + heat.made_by_bonds;
}
#endif
#endif

// The heat rate of a particle whose pairs and walls are summed. Outside values are those of the middle of the next step.
DEVICE real heat_rate_of(const Step step, const u32 i, const u32 material, Heat *heat, const Heated heated)
{
#if EXPOSED
    const Exposure exposed = heated.exposures[heated.exposure[i]];
    for (u32 k = exposed.first_exchange; k < exposed.end_exchange; ++k) {
        const Exchanging exchanging = heated.exchanges[k];
        Exchange exchange = exchanging.exchange;
#if CONDUCTIVITY_TABLES
        const Tabled table = heated.conductivities[material];
        tempered_exchange(exchanging.exchange,
                          property_at(heated.pieces, table.first_piece, table.end_piece, heat->temperature), &exchange);
#endif
        real rate;
        surface_heat(exchange, heat->temperature, outside_of(exchanging, step.heat_middle_time, heated), &rate);
        heat->foreign += rate;
    }
#endif
    real rate = 0.0;
#if HEAT && BONDS
    rate = heat->contacts + heat->bonds + heat->foreign;
#elif HEAT
    rate = heat->contacts + heat->foreign;
#endif
#if MAKES_HEAT
    real of_motion;
    heat_rate_of_motion(made_heat(*heat), step.heat_dt, &of_motion);
    rate += of_motion;
#endif
    return rate;
}

#if EXPANSION_WORK
// What the energy in all springs gains per kelvin of a particle, J/K.
DEVICE real work_per_kelvin_of(const u32 i, const u32 material, const Heat heat, const Heated heated)
{
    real work = 0.0;
#if EXPANDS
    expansion_work_of_contacts(heat.pressure_of_contacts + heat.pressure_of_walls, heated.thermals[material].expansion,
                               heated.reference_radius[i], &work);
#endif
#if BONDS
    work += heat.work_of_bonds;
#endif
    return work;
}
#endif

#if HEAT
// To the temperature of the end of the step, from the heat rate of its beginning, and to the radius that belongs to it;
// returns a flag if that is no temperature.
DEVICE u32 warm(const Step step, const u32 i, const u32 material, const real rate, const Heated heated, Sphere *body,
#if LEDGER
                GLOBAL Quad *RESTRICT heat_accounts,
#if EXPANSION_WORK
                GLOBAL const real *RESTRICT work_per_kelvin, GLOBAL real *RESTRICT warming,
#endif
#endif
                real *temperature)
{
    const Thermal thermal = heated.thermals[material];
    real now;
#if SPECIFIC_HEAT_TABLES
    const Tabled specific_heat = heated.specific_heats[material];
    real taken_in;
    heat_taken_in(rate, body->mass, step.heat_dt, &taken_in);
    now = warmed_along(heated.pieces, specific_heat, *temperature, taken_in);
#else
    const real capacity = body->mass * thermal.specific_heat;
    warmed(*temperature, rate, capacity, step.heat_dt, &now);
#endif
#if EXPOSED
    const Exposure exposed = heated.exposures[heated.exposure[i]];
    if (exposed.first_piece < exposed.end_piece) {
        const real free = now;
        now = course_at(heated.pieces, exposed.first_piece, exposed.end_piece, step.next_heat_time);
#if LEDGER && SPECIFIC_HEAT_TABLES
        book_heat(i, body->mass * heat_between(heated.pieces, specific_heat, free, now), heat_accounts);
#elif LEDGER
        book_heat(i, capacity * (now - free), heat_accounts);
#endif
    }
#endif
#if EXPANDS
    real radius;
    grown(heated.reference_radius[i], thermal.expansion, now - step.reference_temperature, &radius);
    body->radius = radius;
#endif
#if EXPANSION_WORK
    const real warmer = now - *temperature;
    warming[i] = warmer;
    book_expansion(i, work_per_kelvin[i], warmer, heat_accounts);
#endif
    *temperature = now;
    return now > 0.0 && now < INFINITY ? 0u : UNPHYSICAL;
}
#endif
