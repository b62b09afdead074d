//! Random numbers that depend on what they are for, not on what was drawn before.
//!
//! Philox 4x32-10 (Salmon, Moraes, Dror & Shaw, *Parallel random numbers: as easy as 1, 2, 3*, SC11): ten rounds that
//! mix a counter under a key. The key is the seed of the case; the counter holds the stream (what the numbers are for),
//! the index of the particle and the attempt. So the numbers of a particle are the same whatever other particles the
//! case has, in whatever order they are made.

/// What random numbers are for. The values are part of the results: they never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stream {
    /// Where a particle is put.
    Position = 1,
    /// How large it is.
    Radius = 2,
    /// How fast it starts and whither.
    Velocity = 3,
    /// How strong a bond is.
    Strength = 4,
}

/// Four words from four words and a key of two.
pub(crate) fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let a = u64::from(counter[0]) * 0xD251_1F53;
        let b = u64::from(counter[2]) * 0xCD9E_8D57;
        let (a_high, a_low) = ((a >> 32) as u32, a as u32);
        let (b_high, b_low) = ((b >> 32) as u32, b as u32);
        counter = [b_high ^ counter[1] ^ key[0], b_low, a_high ^ counter[3] ^ key[1], a_low];
        key = [key[0].wrapping_add(0x9E37_79B9), key[1].wrapping_add(0xBB67_AE85)];
    }
    counter
}

/// Four numbers in [0, 1), each a multiple of 2^-32. An attempt that needs more takes the next attempt.
pub(crate) fn uniform4(seed: u64, stream: Stream, block: u32, index: u32, attempt: u32) -> [f64; 4] {
    let key = [seed as u32, (seed >> 32) as u32];
    philox([stream as u32, block, index, attempt], key).map(|word| f64::from(word) * (1.0 / 4_294_967_296.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_published_answers() {
        // Known-answer vectors of the authors' library, Random123.
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox([u32::MAX; 4], [u32::MAX; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
    }

    #[test]
    fn numbers_depend_on_all_that_they_are_for() {
        let draw = uniform4(1, Stream::Velocity, 0, 7, 0);
        assert_eq!(draw, uniform4(1, Stream::Velocity, 0, 7, 0));
        assert_ne!(draw, uniform4(2, Stream::Velocity, 0, 7, 0));
        assert_ne!(draw, uniform4(1, Stream::Position, 0, 7, 0));
        assert_ne!(draw, uniform4(1, Stream::Velocity, 1, 7, 0));
        assert_ne!(draw, uniform4(1, Stream::Velocity, 0, 8, 0));
        assert_ne!(draw, uniform4(1, Stream::Velocity, 0, 7, 1));
        assert!(draw.iter().all(|u| (0.0..1.0).contains(u)));
    }
}
