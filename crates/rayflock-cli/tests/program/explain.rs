//! `--explain`.

use crate::Workplace;

#[test]
fn every_batch_of_every_frame_is_explained() {
    let work = Workplace::new();
    let run = work.run("render builtin:cornell --size 16x12 --frames 2..3 --explain -o x.gif");
    assert_eq!(run.code, 0, "{run:?}");
    let said = run.stderr;
    for frame in ["frame 2: ", "frame 3: "] {
        let line = said.lines().find(|line| line.starts_with(frame)).expect("a line a frame");
        assert!(
            line.contains(" rays of an image from one point past ") && line.contains("took "),
            "{line}"
        );
        assert!(line.contains("hierarchy ") && line.contains("bvh "), "{line}");
    }
}
