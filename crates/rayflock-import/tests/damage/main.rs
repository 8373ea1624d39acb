//! Damaged files of every format give an error or a scene that makes frames, never a panic, and
//! soon.

mod samples;
mod survive;

use proptest::prelude::*;
use rayflock_import::{Reporter, load};

use samples::{MTL, arrays, samples, write_neighbours};
use survive::{ask, load_in, show_frames};

/// Number of [`samples()`].
const SAMPLE_COUNT: usize = 15;

/// A change to a file.
#[derive(Clone, Debug)]
enum Damage {
    Cut(prop::sample::Index),
    Byte(prop::sample::Index, u8),
    Remove(prop::sample::Index, usize),
    /// A number in place of one of the digits of the text.
    Number(prop::sample::Index, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let numbers = ["-1", "0", "4294967295", "4294967296", "99999999999999999999", "1e39", "nan"];
    prop_oneof![
        1 => any::<prop::sample::Index>().prop_map(Damage::Cut),
        4 => (any::<prop::sample::Index>(), any::<u8>()).prop_map(|(at, b)| Damage::Byte(at, b)),
        2 => (any::<prop::sample::Index>(), 1..40_usize).prop_map(|(at, n)| Damage::Remove(at, n)),
        4 => (any::<prop::sample::Index>(), prop::sample::select(numbers.to_vec()))
            .prop_map(|(at, number)| Damage::Number(at, number)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    if bytes.is_empty() {
        return;
    }
    match damage {
        Damage::Cut(at) => bytes.truncate(at.index(bytes.len())),
        Damage::Byte(at, byte) => {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        Damage::Remove(at, count) => {
            let at = at.index(bytes.len());
            bytes.drain(at..(at + count).min(bytes.len()));
        }
        Damage::Number(at, number) => {
            let digits: Vec<usize> =
                (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
            if !digits.is_empty() {
                let at = digits[at.index(digits.len())];
                bytes.splice(at..at + 1, number.bytes());
            }
        }
    }
}

#[test]
fn the_samples_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    write_neighbours(folder.path());
    assert_eq!(samples().len(), SAMPLE_COUNT);
    for (name, bytes) in samples() {
        let loaded = load_in(folder.path(), name, &bytes);
        assert!(loaded.as_ref().is_ok_and(|count| *count > 0), "{name}: {loaded:?}");
    }
}

#[test]
fn every_beginning_of_a_file_is_survived() {
    let folder = tempfile::tempdir().unwrap();
    write_neighbours(folder.path());
    for (name, bytes) in samples() {
        for length in 0..bytes.len() {
            let _ = load_in(folder.path(), name, &bytes[..length]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_survived(
        sample_idx in 0..SAMPLE_COUNT,
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let (name, mut bytes) = samples().swap_remove(sample_idx);
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        write_neighbours(folder.path());
        let _ = load_in(folder.path(), name, &bytes);
    }

    #[test]
    fn damaged_mtl_files_are_survived(damages in prop::collection::vec(damage(), 1..6)) {
        let folder = tempfile::tempdir().unwrap();
        let mut bytes = MTL.to_vec();
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        prop_assert!(ask("mtl", folder.path(), &bytes).is_ok());
    }

    #[test]
    fn garbage_is_survived(name in 0..SAMPLE_COUNT, bytes in prop::collection::vec(any::<u8>(), 0..500)) {
        let folder = tempfile::tempdir().unwrap();
        write_neighbours(folder.path());
        let _ = load_in(folder.path(), samples()[name].0, &bytes);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    /// Damage that the checksums of a zip file would find.
    #[test]
    fn damaged_arrays_are_survived(
        array_idx in 0..6_usize,
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut bytes = arrays()[array_idx].1.clone();
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        bytes.insert(0, array_idx as u8);
        let _ = ask("npy", folder.path(), &bytes);
    }

    #[test]
    fn damaged_frames_are_survived(
        sample_idx in 0..SAMPLE_COUNT,
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        let (name, mut bytes) = samples().swap_remove(sample_idx);
        let extension = &name[2..];
        if ["obj", "ply", "stl", "vtk", "vtp"].contains(&extension) {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("1").with_extension(extension), &bytes).unwrap();
            damages.iter().for_each(|damage| apply(&mut bytes, damage));
            std::fs::write(folder.path().join("2").with_extension(extension), &bytes).unwrap();
            let scene = load(folder.path(), &mut Reporter::new()).unwrap();
            prop_assert_eq!(scene.frame_count, Some(2));
            let _ = show_frames(scene);
        }
    }
}
