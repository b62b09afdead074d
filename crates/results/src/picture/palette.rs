//! Colour maps by name, and the colours of backgrounds, letters and lines.

/// A colour map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// From dark blue over green to yellow, ascending evenly in lightness: also in grey and for the colour-blind.
    Viridis,
    /// From black over red to pale yellow, ascending evenly in lightness.
    Inferno,
    /// From blue over pale grey to red: for values with a meaningful middle.
    Coolwarm,
    /// From dark to light grey, for print.
    Grey,
}

/// The background of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// White.
    #[default]
    White,
    /// Dark grey, for slides.
    Dark,
    /// None: the picture has an alpha channel.
    Transparent,
}

/// Red, green and blue.
pub(super) type Rgb = [u8; 3];

/// Where a value is not a number.
const NOTHING: [f32; 3] = [0.5; 3];

impl ColourMap {
    /// All of them.
    pub const ALL: [ColourMap; 4] = [ColourMap::Viridis, ColourMap::Inferno, ColourMap::Coolwarm, ColourMap::Grey];

    /// Its name in case files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ColourMap::Viridis => "viridis",
            ColourMap::Inferno => "inferno",
            ColourMap::Coolwarm => "coolwarm",
            ColourMap::Grey => "grey",
        }
    }

    /// Whether its middle stands for a value of its own, such as 0.
    #[must_use]
    pub fn diverges(self) -> bool {
        self == ColourMap::Coolwarm
    }

    /// The colour of a shade from 0 to 1; red, green and blue between 0 and 1. What is not a number is grey.
    pub(super) fn colour(self, shade: f32) -> [f32; 3] {
        if shade.is_nan() {
            return NOTHING;
        }
        let stops = self.stops();
        let place = shade.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
        let stop = (place as usize).min(stops.len() - 2);
        let share = place - stop as f32;
        let [low, high] = [stops[stop], stops[stop + 1]].map(|colour| {
            let [_, red, green, blue] = colour.to_be_bytes();
            [red, green, blue].map(|channel| f32::from(channel) / 255.0)
        });
        std::array::from_fn(|k| low[k] + share * (high[k] - low[k]))
    }

    /// Colours at even distances, `0xRRGGBB`; between them they change linearly, which is within 1/255 of the published tables.
    fn stops(self) -> &'static [u32] {
        match self {
            ColourMap::Viridis => &VIRIDIS,
            ColourMap::Inferno => &INFERNO,
            ColourMap::Coolwarm => &COOLWARM,
            ColourMap::Grey => &[0x26_2626, 0xf2_f2f2],
        }
    }
}

impl Background {
    /// Its colour, and whether it covers what lies behind it.
    pub(super) fn fill(self) -> (Rgb, bool) {
        match self {
            Background::White => ([255; 3], true),
            Background::Dark => ([0x16, 0x18, 0x1d], true),
            Background::Transparent => ([0; 3], false),
        }
    }

    /// Letters and ticks. On an unknown background a grey that both black and white leave readable.
    pub(super) fn ink(self) -> Rgb {
        match self {
            Background::White => [0x22, 0x26, 0x2e],
            Background::Dark => [0xe4, 0xe6, 0xea],
            Background::Transparent => [0x77, 0x7b, 0x83],
        }
    }

    /// Outlines of walls.
    pub(super) fn line(self) -> Rgb {
        match self {
            Background::White => [90, 95, 105],
            Background::Dark => [150, 155, 165],
            Background::Transparent => [0x77, 0x7b, 0x83],
        }
    }
}

/// Every fifth colour of `viridis`, by S. van der Walt and N. Smith (2015), dedicated to the public (CC0).
const VIRIDIS: [u32; 52] = [
    0x44_0154, 0x46_085c, 0x47_1063, 0x48_1769, 0x48_1d6f, 0x48_2475, 0x47_2a7a, 0x46_307e, 0x45_3781, 0x43_3d84,
    0x41_4287, 0x3f_4889, 0x3d_4e8a, 0x3a_538b, 0x38_598c, 0x35_5e8d, 0x33_638d, 0x31_688e, 0x2e_6d8e, 0x2c_718e,
    0x2a_768e, 0x29_7b8e, 0x27_808e, 0x25_848e, 0x23_898e, 0x21_8e8d, 0x20_928c, 0x1f_978b, 0x1e_9c89, 0x1f_a188,
    0x21_a585, 0x24_aa83, 0x28_ae80, 0x2e_b37c, 0x35_b779, 0x3d_bc74, 0x46_c06f, 0x50_c46a, 0x5a_c864, 0x65_cb5e,
    0x70_cf57, 0x7c_d250, 0x89_d548, 0x95_d840, 0xa2_da37, 0xb0_dd2f, 0xbd_df26, 0xca_e11f, 0xd8_e219, 0xe5_e419,
    0xf1_e51d, 0xfd_e725,
];
/// Every fifth colour of `inferno`, by the same.
const INFERNO: [u32; 52] = [
    0x00_0004, 0x02_020c, 0x05_0417, 0x0a_0722, 0x10_092d, 0x16_0b39, 0x1e_0c45, 0x26_0c51, 0x2f_0a5b, 0x38_0962,
    0x40_0a67, 0x49_0b6a, 0x51_0e6c, 0x59_106e, 0x61_136e, 0x69_166e, 0x71_196e, 0x78_1c6d, 0x80_1f6c, 0x88_226a,
    0x90_2568, 0x98_2766, 0xa0_2a63, 0xa8_2e5f, 0xb0_315b, 0xb7_3557, 0xbf_3952, 0xc6_3d4d, 0xcc_4248, 0xd3_4743,
    0xd9_4d3d, 0xdf_5337, 0xe4_5a31, 0xe9_612b, 0xed_6925, 0xf1_711f, 0xf4_7918, 0xf7_8212, 0xf9_8b0b, 0xfa_9407,
    0xfb_9d07, 0xfc_a60c, 0xfc_b014, 0xfb_ba1f, 0xfa_c42a, 0xf8_cd37, 0xf6_d746, 0xf4_e156, 0xf2_ea69, 0xf2_f27d,
    0xf5_f992, 0xfc_ffa4,
];
/// The diverging colours of K. Moreland, Diverging color maps for scientific visualization, ISVC 2009, his table of 33.
const COOLWARM: [u32; 33] = [
    0x3b_4cc0, 0x44_5acc, 0x4d_68d7, 0x57_75e1, 0x62_82ea, 0x6c_8ef1, 0x77_9af7, 0x82_a5fb, 0x8d_b0fe, 0x98_b9ff,
    0xa3_c2ff, 0xae_c9fd, 0xb8_d0f9, 0xc2_d5f4, 0xcc_d9ee, 0xd5_dbe6, 0xdd_dddd, 0xe5_d8d1, 0xec_d3c5, 0xf1_ccb9,
    0xf5_c4ad, 0xf7_bba0, 0xf7_b194, 0xf7_a687, 0xf4_9a7b, 0xf1_8d6f, 0xec_7f63, 0xe5_7058, 0xde_604d, 0xd5_5042,
    0xcb_3e38, 0xc0_282f, 0xb4_0426,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of sRGB, IEC 61966-2-1.
    fn luminance(colour: [f32; 3]) -> f32 {
        let linear = colour.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    #[test]
    fn sequential_maps_ascend_in_lightness_and_the_diverging_one_is_palest_in_its_middle() {
        let of = |map: ColourMap| (0..=100).map(move |k| luminance(map.colour(k as f32 / 100.0)));
        for map in ColourMap::ALL.into_iter().filter(|map| !map.diverges()) {
            assert!(of(map).is_sorted(), "{map:?}");
        }
        let coolwarm: Vec<f32> = of(ColourMap::Coolwarm).collect();
        assert!(coolwarm[..=50].is_sorted() && coolwarm[50..].iter().rev().is_sorted());
    }

    #[test]
    fn colours_are_those_of_the_published_tables() {
        // Entries of the tables of 256 that are not among the stops: 128 of viridis, 201 of inferno; the middle of coolwarm.
        let bytes = |map: ColourMap, shade: f32| map.colour(shade).map(|channel| channel * 255.0);
        let near = |found: [f32; 3], expected: [f32; 3]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1.5), "{found:?} {expected:?}");
        };
        near(bytes(ColourMap::Viridis, 128.0 / 255.0), [32.5, 144.6, 140.4]);
        near(bytes(ColourMap::Inferno, 201.0 / 255.0), [251.6, 158.9, 7.1]);
        near(bytes(ColourMap::Coolwarm, 0.5), [221.0, 221.0, 221.0]);
        near(bytes(ColourMap::Grey, f32::NAN), [127.5; 3]);
    }
}
