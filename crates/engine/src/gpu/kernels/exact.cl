// Exact sums, rounded once, to the bits of `exact.rs`: integers may be added in any order.
//
// A group has up to CHUNK terms, in local memory. Parts of them that are multiples of one unit add as reals without rounding
// (see `ExactSum::add_chunk`, which has the bounds); their sums, and what is left of terms, are split over digits of 16 bits
// in words of 32, first those of the group, then some for all groups, of which several copies exist. No atomic operation has
// more than 32 bits.

// Work-items of a group, its terms, and the items of a warp.
#define GROUP  256u
#define CHUNK  1024u
#define SIDE   32u

// Digit k of a sum is worth 2^(16 k - 1074); the words of a digit are integers with a sign, in two's complement.
#define DIGITS  135u
// Behind them a word of flags: what is no finite number.
#define WORDS   136u
#define IS_NAN  1u
#define IS_PLUS_INFINITY   2u
#define IS_MINUS_INFINITY  4u

// Bits of a part of a term, and how many parts there are.
#define PART_BITS  41u
#define PARTS      3u
// Terms of a work-item.
#define TURNS      4u
// Work-items that add up the parts of a term, in the first of two rounds.
#define ADDERS     16u

DEVICE void add_digits(IN_LOCAL u32 *digits, const real term)
{
    const u64 bits = BITS_OF(term), one = 1u;
    const u64 fraction = bits & ((one << 52) - one);
    const u32 exponent = (u32)(bits >> 52) & 0x7ffu;
    const u32 negative = (u32)(bits >> 63);
    if (exponent == 0x7ffu) {
        ATOMIC_OR(digits + DIGITS, fraction ? IS_NAN : negative ? IS_MINUS_INFINITY : IS_PLUS_INFINITY);
        return;
    }
    const u64 mantissa = exponent ? fraction | (one << 52) : fraction;
    const u32 place = exponent ? exponent - 1u : 0u, shift = place % 16u;
    // 53 bits shifted by up to 15 are 68 bits: five digits.
    u64 low = mantissa << shift;
    const u32 high = shift ? (u32)(mantissa >> (64u - shift)) : 0u;
    for (u32 k = 0; k < 5u; ++k, low >>= 16) {
        const u32 digit = k == 4u ? high : (u32)low & 0xffffu;
        if (digit)
            ATOMIC_ADD(digits + place / 16u + k, negative ? 0u - digit : digit);
    }
}

// The largest magnitude of the terms of a work-item, by the high word of its bits.
DEVICE void look_for_largest(IN_LOCAL const real *terms, IN_LOCAL u32 *largest)
{
    u32 mine = 0u;
    for (u32 turn = 0; turn < TURNS; ++turn) {
        const u32 size = (u32)(BITS_OF(terms[TURNS * LOCAL_INDEX + turn]) >> 32) & 0x7fffffffu;
        mine = size > mine ? size : mine;
    }
    // Who sees an older value asks once too often.
    if (mine > *largest)
        ATOMIC_MAX(largest, mine);
}

// Splits the terms of a work-item into parts, whose sums take their places. What is left goes into digits.
DEVICE void take_apart(IN_LOCAL real *terms, const u32 largest, IN_LOCAL u32 *digits)
{
    const u32 exponent = largest >> 20;
    real left[TURNS], sum[PARTS];
    for (u32 turn = 0; turn < TURNS; ++turn)
        left[turn] = terms[TURNS * LOCAL_INDEX + turn];
    if (exponent + 13u < 0x7ffu && exponent >= PARTS * PART_BITS + 64u) {
        for (u32 p = 0; p < PARTS; ++p) {
            const real unit = REAL_OF((u64)(exponent + 13u - p * PART_BITS) << 52);
            real part[TURNS];
            for (u32 turn = 0; turn < TURNS; ++turn) {
                part[turn] = (unit + left[turn]) - unit;
                left[turn] -= part[turn];
            }
            sum[p] = (part[0] + part[1]) + (part[2] + part[3]);
        }
    } else {
        for (u32 p = 0; p < PARTS; ++p)
            sum[p] = 0.0;
    }
    for (u32 p = 0; p < PARTS; ++p)
        terms[TURNS * LOCAL_INDEX + p] = sum[p];
    if (left[0] != 0.0 || left[1] != 0.0 || left[2] != 0.0 || left[3] != 0.0)
        for (u32 turn = 0; turn < TURNS; ++turn)
            add_digits(digits, left[turn]);
}

// What a word of a group becomes when carries are taken out of digits, once: at most 2^15 + 2^11.
DEVICE u32 settled_digit(IN_LOCAL const u32 *digits, const u32 k)
{
    const i32 digit = (i32)digits[k];
    const i32 carry = k + 1u < DIGITS ? (digit + 0x8000) >> 16 : 0;
    const i32 from_below = k ? ((i32)digits[k - 1u] + 0x8000) >> 16 : 0;
    return (u32)(digit - carry * 0x10000 + from_below);
}

// Room for the terms of so many sums: term k of sum s stands at terms[s * CHUNK + k].
#define ROOM_FOR_TERMS(sums)                                                  \
    LOCAL real terms[(sums) * CHUNK];                                         \
    LOCAL u32 digits[(sums) * WORDS];                                         \
    LOCAL u32 largest[sums];                                                  \
    for (u32 sum = 0; sum < (sums); ++sum)                                    \
        if (LOCAL_INDEX < WORDS)                                              \
            digits[sum * WORDS + LOCAL_INDEX] = 0u;                           \
    if (LOCAL_INDEX < (sums))                                                 \
        largest[LOCAL_INDEX] = 0u

// Adds the terms of a group, so many of each sum, to words of which there are so many copies; all of the group must come here.
#define ADD_TERMS(sums, count, copies, into)                                  \
    for (u32 sum = 0; sum < (sums); ++sum)                                    \
        for (u32 k = (count) + LOCAL_INDEX; k < CHUNK; k += GROUP)            \
            terms[sum * CHUNK + k] = 0.0;                                     \
    BARRIER;                                                                  \
    for (u32 sum = 0; sum < (sums); ++sum)                                    \
        look_for_largest(terms + sum * CHUNK, largest + sum);                 \
    BARRIER;                                                                  \
    for (u32 sum = 0; sum < (sums); ++sum)                                    \
        take_apart(terms + sum * CHUNK, largest[sum], digits + sum * WORDS);  \
    BARRIER;                                                                  \
    {                                                                         \
        const u32 sum = LOCAL_INDEX / 64u, adder = LOCAL_INDEX % 64u, part = adder / ADDERS; \
        if (sum < (sums) && part < PARTS) {                                   \
            real of_part = 0.0;                                               \
            for (u32 k = adder % ADDERS; k < GROUP; k += ADDERS)              \
                of_part += terms[sum * CHUNK + TURNS * k + part];             \
            terms[sum * CHUNK + TURNS * adder + PARTS] = of_part;             \
        }                                                                     \
    }                                                                         \
    BARRIER;                                                                  \
    {                                                                         \
        const u32 sum = LOCAL_INDEX / 64u, part = LOCAL_INDEX % 64u;          \
        if (sum < (sums) && part < PARTS) {                                   \
            real of_part = 0.0;                                               \
            for (u32 k = 0; k < ADDERS; ++k)                                  \
                of_part += terms[sum * CHUNK + TURNS * (part * ADDERS + k) + PARTS]; \
            if (of_part != 0.0)                                               \
                add_digits(digits + sum * WORDS, of_part);                    \
        }                                                                     \
    }                                                                         \
    BARRIER;                                                                  \
    for (u32 sum = 0; sum < (sums); ++sum) {                                  \
        const u32 to = (sum * (copies) + GROUP_INDEX % (copies)) * WORDS + LOCAL_INDEX; \
        if (LOCAL_INDEX < DIGITS) {                                           \
            const u32 more = settled_digit(digits + sum * WORDS, LOCAL_INDEX); \
            if (more)                                                         \
                ATOMIC_ADD((into) + to, more);                                \
        } else if (LOCAL_INDEX == DIGITS && digits[sum * WORDS + DIGITS]) {   \
            ATOMIC_OR((into) + to, digits[sum * WORDS + DIGITS]);             \
        }                                                                     \
    }

// The nearest real of so many digits and a word of flags, ties to even. The digits are changed.
DEVICE real rounded(IN_LOCAL i64 *digits)
{
    const u32 flags = (u32)digits[DIGITS];
    if (flags & IS_NAN || (flags & IS_PLUS_INFINITY && flags & IS_MINUS_INFINITY))
        return NAN;
    if (flags)
        return flags & IS_PLUS_INFINITY ? INFINITY : -INFINITY;
    i64 carry = 0;
    for (u32 k = 0; k < DIGITS; ++k) {
        const i64 digit = digits[k] + carry;
        carry = digit >> 16;
        digits[k] = digit & 0xffff;
    }
    // What goes out of the highest digit is the sign.
    const u32 negative = carry < 0;
    if (negative) {
        carry = 1;
        for (u32 k = 0; k < DIGITS; ++k) {
            const i64 digit = (digits[k] ^ 0xffff) + carry;
            carry = digit >> 16;
            digits[k] = digit & 0xffff;
        }
    }
    u32 end = DIGITS;
    while (end > 0u && digits[end - 1u] == 0)
        --end;
    if (end == 0u)
        return 0.0;
    // The leading bit is the highest of 64, and stands for 2^(place - 1074).
    u64 high = 0u;
    for (u32 k = 1; k <= 4u; ++k)
        high = high << 16 | (k <= end ? (u64)digits[end - k] : 0u);
    u32 zeros = 0u;
    while (!(high >> 63)) {
        high <<= 1;
        ++zeros;
    }
    const u32 last = end > 4u ? (u32)digits[end - 5u] : 0u;
    high |= last >> (16u - zeros);
    const u32 place = 16u * end - 1u - zeros;
    u64 bits;
    if (place < 53u) {
        bits = high >> (63u - place);
    } else {
        u32 is_beyond = (last & ((1u << (16u - zeros)) - 1u)) != 0u;
        for (u32 k = 5u; k < end; ++k)
            is_beyond |= digits[end - 1u - k] != 0;
        const u64 mantissa = high >> 11;
        const u32 rest = (u32)high & 0x7ffu;
        const u32 up = rest > 0x400u || (rest == 0x400u && (is_beyond || ((u32)mantissa & 1u)));
        // The mantissa has 53 bits, of which the first one adds one to the exponent; a carry out of it does the same.
        bits = ((u64)(place - 52u) << 52) + mantissa + up;
    }
    const u64 infinite = (u64)0x7ffu << 52;
    const real size = REAL_OF(bits < infinite ? bits : infinite);
    return negative ? -size : size;
}

// So many sums of all that was added to words, which are zeros again; all of the one group must come here.
#define TAKE_SUMS(sums, copies, from)                                         \
    LOCAL i64 digits[(sums) * WORDS];                                         \
    LOCAL real totals[sums];                                                  \
    for (u32 word = LOCAL_INDEX; word < (sums) * WORDS; word += GROUP) {      \
        const u32 sum = word / WORDS, k = word % WORDS;                       \
        i64 total = 0;                                                        \
        for (u32 copy = 0; copy < (copies); ++copy) {                         \
            const u32 at = (sum * (copies) + copy) * WORDS + k;               \
            const u32 found = (from)[at];                                     \
            total = k < DIGITS ? total + (i32)found : total | found;          \
            (from)[at] = 0u;                                                  \
        }                                                                     \
        digits[word] = total;                                                 \
    }                                                                         \
    BARRIER;                                                                  \
    if (LOCAL_INDEX % SIDE == 0u && LOCAL_INDEX / SIDE < (sums))              \
        totals[LOCAL_INDEX / SIDE] = rounded(digits + LOCAL_INDEX / SIDE * WORDS); \
    BARRIER
