//! The quick-look pictures.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use tdem_engine::physics::bond::Failure;
use tdem_engine::{Breakage, State};
use tdem_results::Error;
use tdem_results::picture::{Background, Clip, Colour, ColourMap, Options, Scale, Subject, render};

fn pixels(state: &State, options: &Options) -> (u32, Vec<[u8; 3]>) {
    let bytes = render(state, &common::plan(), options).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut buffer).unwrap();
    (info.width, buffer.as_chunks().0.to_vec())
}

/// Two spheres, one behind the other as seen along -y.
fn two_in_line() -> State {
    let mut state = common::state();
    for field in [&mut state.position, &mut state.velocity] {
        field.truncate(2);
    }
    state.id.truncate(2);
    state.radius = vec![0.1, 0.1];
    state.position = vec![[0.3, 0.1, 0.4], [0.3, 0.4, 0.4]];
    state.velocity = vec![[0.0; 3], [1.0, 0.0, 0.0]];
    state
}

const FROM_THE_FRONT: Options = Options {
    width: 81,
    height: 61,
    direction: [0.0, -1.0, 0.0],
    view_angle_deg: 25.0,
    subject: Subject::Particles,
    colour: Colour::Speed,
    range: None,
    map: None,
    background: Background::White,
    scale: Scale::Kelvin,
    clip: None,
    walls: false,
    bar: false,
    smooth: false,
};

#[test]
fn the_nearer_sphere_hides_the_farther_one() {
    let mut state = two_in_line();
    let (width, front) = pixels(&state, &FROM_THE_FRONT);
    let middle = (30 * width + 40) as usize;
    let [red, _, blue] = front[middle];
    assert!(blue > red, "the slow one is dark blue: {:?}", front[middle]);
    assert_eq!(front[0], [255; 3], "the background is white");
    state.position.swap(0, 1);
    let [red, _, blue] = pixels(&state, &FROM_THE_FRONT).1[middle];
    assert!(red > blue, "the fast one is yellow");
}

#[test]
fn walls_are_outlined_behind_and_between_spheres() {
    let options = Options { walls: true, subject: Subject::Domain, ..FROM_THE_FRONT };
    let (_, with) = pixels(&two_in_line(), &options);
    let (_, without) = pixels(&two_in_line(), &Options { walls: false, ..options });
    let changed = with.iter().zip(&without).filter(|(a, b)| a != b).count();
    assert!((50..600).contains(&changed), "{changed}");
}

#[test]
fn pictures_are_the_same_every_time_also_of_nothing() {
    let options = Options { width: 120, height: 90, ..Options::default() };
    assert!(pixels(&common::state(), &options) == pixels(&common::state(), &options));
    let empty = State { wall_position: common::state().wall_position, ..State::default() };
    let (_, nothing) = pixels(&empty, &Options { walls: false, ..options });
    assert!(nothing.iter().all(|&pixel| pixel == [255; 3]));
}

#[test]
fn colours_tell_damage_and_stress() {
    let (mut state, plan) = common::bonded();
    assert!(Colour::Damage.values(&state, &plan).iter().all(|&damage| damage == 0.0));
    state.bonds[0].breakage = Some(Breakage { step: 1, failure: Failure::Tension, energy: 0.0 });
    let damage = Colour::Damage.values(&state, &plan);
    let damaged: Vec<u32> =
        state.id.iter().zip(&damage).filter(|(_, damage)| **damage > 0.0).map(|(id, _)| *id).collect();
    assert_eq!(damaged, [state.bonds[0].first, state.bonds[0].second]);

    // A ball at a corner is moved: only it and its neighbours are under stress.
    state.position[0][0] -= 1e-4;
    let stress = Colour::Stress.values(&state, &plan);
    let neighbour = state.bonds.iter().find(|bond| bond.holds() && bond.first == 0).unwrap().second;
    assert!(stress[neighbour as usize] != 0.0 && stress[35].abs() < 1e-6 * stress[neighbour as usize].abs());
    let options = Options { colour: Colour::Damage, subject: Subject::Domain, ..FROM_THE_FRONT };
    let bytes = render(&state, &plan, &options).unwrap();
    assert!(bytes != render(&state, &plan, &Options { colour: Colour::Stress, ..options }).unwrap());
}

#[test]
fn a_plane_cuts_away_what_hides() {
    let state = two_in_line();
    let middle = 30 * 81 + 40;
    let red_of = |clip| {
        let (_, pixels) = pixels(&state, &Options { clip, ..FROM_THE_FRONT });
        pixels[middle]
    };
    let [red, _, blue] = red_of(None);
    assert!(blue > red, "the slow one is in front");
    let beyond = |normal| Some(Clip { point: [0.0, 0.25, 0.0], normal });
    let [red, _, blue] = red_of(beyond([0.0, -2.0, 0.0]));
    assert!(red > blue, "without it the fast one is seen");
    assert_eq!(red_of(beyond([0.0, 1.0, 0.0])), red_of(None), "what lies behind may go");
    assert!(Clip { point: [0.0; 3], normal: [1.0, 0.0, 0.0] }.keeps([0.0, 5.0, 5.0]), "the plane itself stays");
}

#[test]
fn a_bar_stands_beside_the_picture_and_the_file_tells_what_it_shows() {
    let options = Options { width: 400, height: 300, range: Some([0.0, 2.0]), ..FROM_THE_FRONT };
    let (_, plain) = pixels(&two_in_line(), &options);
    let (width, with) = pixels(&two_in_line(), &Options { bar: true, ..options });
    assert_eq!(width, 400, "it takes its room from the picture");
    let inked = |pixels: &[[u8; 3]]| pixels.chunks(400).flat_map(|row| &row[330..]).filter(|p| **p != [255; 3]).count();
    assert!(inked(&with) > inked(&plain) + 1000);
    let bytes = render(&two_in_line(), &common::plan(), &options).expect("it can be drawn");
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("it is a PNG file");
    let told: Vec<(&str, &str)> =
        reader.info().uncompressed_latin1_text.iter().map(|chunk| (&*chunk.keyword, &*chunk.text)).collect();
    assert_eq!(told, [("step", "0"), ("time", "0"), ("field", "velocity"), ("low", "0"), ("high", "2")]);
}

#[test]
fn ranges_begin_where_nothing_is() {
    let range = |colour: Colour, values: &[f64]| colour.range(colour.extent(values), colour.map());
    assert_eq!(range(Colour::Damage, &[0.0, 0.0]), [0.0, 1.0]);
    assert_eq!(range(Colour::Damage, &[0.1, 0.5]), [0.0, 0.5]);
    assert_eq!(range(Colour::Material, &[1.0, 2.0]), [0.0, 2.0]);
    assert_eq!(range(Colour::Temperature, &[f64::NAN, 300.0, 400.0]), [300.0, 400.0]);
}

#[test]
fn zero_is_in_the_middle_of_a_map_that_diverges() {
    let range = |values: &[f64], map| Colour::Stress.range(Colour::Stress.extent(values), map);
    assert_eq!(range(&[-3.0, 1.0], ColourMap::Coolwarm), [-3.0, 3.0]);
    assert_eq!(range(&[1.0, 3.0], ColourMap::Coolwarm), [1.0, 3.0], "there is no zero between them");
    assert_eq!(range(&[-3.0, 1.0], ColourMap::Grey), [-3.0, 1.0]);
}

#[test]
fn backgrounds_are_dark_or_let_through_what_lies_behind() {
    let (state, plan) = (two_in_line(), common::plan());
    let corner = |background| {
        let bytes = render(&state, &plan, &Options { background, ..FROM_THE_FRONT }).expect("it can be drawn");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("it is a PNG file");
        let mut buffer = vec![0; reader.output_buffer_size().expect("it is small")];
        let info = reader.next_frame(&mut buffer).expect("it is whole");
        let channels = info.color_type.samples();
        let middle = (30 * 81 + 40) * channels;
        (channels, buffer[..channels].to_vec(), buffer[middle..middle + channels].to_vec())
    };
    let (channels, clear, sphere) = corner(Background::Transparent);
    assert_eq!((channels, clear[3], sphere[3]), (4, 0, 255));
    let (channels, dark, of_dark) = corner(Background::Dark);
    assert!(channels == 3 && dark.iter().all(|&channel| channel < 40));
    assert_eq!(of_dark[..], sphere[..3], "a sphere looks the same before each");
}

#[test]
fn impossible_sizes_are_refused() {
    for (width, height) in [(0, 10), (10, 0), (20_000, 10)] {
        let result = render(&common::state(), &common::plan(), &Options { width, height, ..Options::default() });
        assert!(matches!(result, Err(Error::PictureSize { .. })));
    }
    let huge = Options { width: 100_000, height: 100_000, ..Options::default() };
    let told = render(&common::state(), &common::plan(), &huge).expect_err("nobody has the memory").to_string();
    assert!(told.contains("100000 x 100000 pixels, which takes some 450 GB"), "{told}");
}
