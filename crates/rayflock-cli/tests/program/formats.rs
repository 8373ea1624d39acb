//! Every format decodes with the right size and number of frames.

use std::process::Command;

use crate::{Workplace, names_in};

const THREE_FRAMES: &str = "render builtin:cornell --size 18x12 --frames 3..5";

#[test]
fn a_picture_is_exactly_at_its_path() {
    let work = Workplace::new();
    work.run_quietly("render builtin:cornell --size 18x12 -o x.png");
    assert_eq!(work.names(), ["x.png"]);
    let picture = image::open(work.path("x.png")).unwrap();
    assert_eq!(picture.color(), image::ColorType::Rgb8);
    assert_eq!((picture.width(), picture.height()), (18, 12));
    let pixels = picture.into_rgb8();
    assert!(pixels.pixels().any(|pixel| pixel != pixels.get_pixel(0, 0)), "nothing is seen");
}

#[test]
fn sixteen_bits_refine_eight() {
    let work = Workplace::new();
    work.run_quietly("render builtin:cornell --size 18x12 -o 8.png");
    work.run_quietly("render builtin:cornell --size 18x12 --bits 16 -o 16.png");
    let deep = image::open(work.path("16.png")).unwrap();
    assert_eq!(deep.color(), image::ColorType::Rgb16);
    let (deep, flat) = (deep.into_rgb16(), image::open(work.path("8.png")).unwrap().into_rgb8());
    for (deep, flat) in deep.as_raw().iter().zip(flat.as_raw()) {
        let off = f32::from(*deep) / 257.0 - f32::from(*flat);
        assert!(off.abs() <= 0.51, "{deep} is not near {flat}");
    }
}

#[test]
fn exr_holds_linear_light_without_exposure() {
    let work = Workplace::new();
    work.run_quietly("render builtin:cornell --size 18x12 --exposure 3 -o a.exr");
    work.run_quietly("render builtin:cornell --size 18x12 -o b.exr");
    assert_eq!(work.read("a.exr"), work.read("b.exr"));
    work.run_quietly("render builtin:cornell --size 18x12 -o b.png");

    let flat = image::open(work.path("b.png")).unwrap().into_rgb8();
    let light = exr::prelude::read_first_rgba_layer_from_file(
        work.path("a.exr"),
        |size, _| vec![[0.0_f32; 3]; size.area()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.y() * 18 + at.x()] = [r, g, b],
    );
    let light = light.unwrap();
    assert_eq!(light.layer_data.size, exr::prelude::Vec2(18, 12));
    let light = light.layer_data.channel_data.pixels;
    for (light, flat) in light.iter().zip(flat.pixels()) {
        let encoded = rayflock::render::tonemap::ToneMap::Srgb.encode((*light).into()) * 255.0;
        assert!((encoded.x - f32::from(flat[0])).abs() <= 0.51, "{light:?} is not {flat:?}");
    }
}

#[test]
fn several_frames_are_numbered() {
    let work = Workplace::new();
    work.run_quietly(&format!("{THREE_FRAMES} -o x.png"));
    work.run_quietly(&format!("{THREE_FRAMES} -o folder/"));
    work.run_quietly(&format!("{THREE_FRAMES} -o other/f%02d_.exr"));
    let expected = [".x_%04d.png.rayflock", "folder", "other", "x_0003.png", "x_0004.png"];
    assert_eq!(work.names()[..5], expected);
    let in_folder = names_in(&work.path("folder"));
    assert_eq!(in_folder[1..], ["frame_0003.png", "frame_0004.png", "frame_0005.png"]);
    let in_other = names_in(&work.path("other"));
    assert_eq!(in_other[1..], ["f03_.exr", "f04_.exr", "f05_.exr"]);
    assert_eq!(work.read("x_0004.png"), work.read("folder/frame_0004.png"));
    assert_ne!(work.read("x_0003.png"), work.read("x_0005.png"), "nothing moves");
}

#[test]
fn a_gif_keeps_its_pace() {
    let work = Workplace::new();
    work.run_quietly(&format!("{THREE_FRAMES} --fps 24 -o x.gif"));
    assert_eq!(work.names(), ["x.gif"]);
    let bytes = work.read("x.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (18, 12));
    let mut delays = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((frame.width, frame.height), (18, 12));
        delays.push(frame.delay);
    }
    // 3 / 24 s is 12.5 hundredths, which no three equal delays can make.
    assert_eq!(delays, [4, 4, 5]);
}

#[test]
fn a_webp_moves() {
    let work = Workplace::new();
    work.run_quietly(&format!("{THREE_FRAMES} --fps 10 -o x.webp"));
    let bytes = work.read("x.webp");
    let decoder = webp_animation::Decoder::new(&bytes).unwrap();
    let frames: Vec<_> = decoder.into_iter().collect();
    assert!(frames.iter().all(|frame| frame.dimensions() == (18, 12)));
    let ends: Vec<_> = frames.iter().map(webp_animation::Frame::timestamp).collect();
    assert_eq!(ends, [100, 200, 300]);
}

#[test]
fn an_mp4_has_every_frame() {
    let work = Workplace::new();
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        println!("skipped: ffmpeg is not installed");
        return;
    }
    work.run_quietly("render builtin:cornell --size 33x17 --frames 3..5 -o x.mp4");
    assert_eq!(work.names(), ["x.mp4"]);
    let mut decode = Command::new("ffmpeg");
    decode.args(["-v", "error", "-i"]).arg(work.path("x.mp4"));
    decode.args(["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]);
    let pixels = decode.output().unwrap().stdout;
    assert_eq!(pixels.len(), 3 * (3 * 34 * 18), "an odd edge is padded to the next even one");
}

#[test]
fn without_ffmpeg_an_mp4_names_the_package() {
    let work = Workplace::new();
    let mut command = work.command(&format!("{THREE_FRAMES} -o x.mp4"));
    let run = crate::Run::from(command.env("PATH", "").output().unwrap());
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("install the package ffmpeg"), "{}", run.stderr);
    assert!(work.names().is_empty());
}

#[test]
fn frames_show_the_same_whatever_the_threads_and_the_engine() {
    let work = Workplace::new();
    let render = "render builtin:cornell --size 18x12 --frames 30";
    work.run_quietly(&format!("{render} --threads 1 -o a.png"));
    work.run_quietly(&format!("{render} --threads 3 --engine brute -o b.png"));
    assert_eq!(work.read("a.png"), work.read("b.png"));
}
