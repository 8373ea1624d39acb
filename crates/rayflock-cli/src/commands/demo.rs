//! `rayflock demo`: a moving picture from nothing.

use clap::Parser;

use super::render;
use crate::args::{Arguments, Command, DemoArguments};
use crate::failure::{Blame, Failure};
use crate::terminal;

/// What the demo renders, as the user could have typed it: four thousand triangles, each on its
/// own path, between mirrors. It took 9 s of processor time, and 5.2 s on two cores, on a server
/// of 2026.
const RENDER: &str = "builtin:museum6 --frames 12..55 --fps 8 --size 320x240";

/// Renders the demo and says what to try next.
pub(super) fn run(args: &DemoArguments) -> Result<(), Failure> {
    let output = args.output.display();
    terminal::say(format_args!("rendering {RENDER} -o {output}"));
    let words = ["rayflock", "render"].into_iter().chain(RENDER.split(' ')).chain(["-o", "x.gif"]);
    let Ok(Arguments { command: Command::Render(mut render) }) = Arguments::try_parse_from(words)
    else {
        unreachable!("the demo's own arguments are well formed")
    };
    render.output.clone_from(&args.output);
    render.engine = args.engine.clone();
    render::run(&render)?;
    terminal::answer(&format!("{output} is there. {NEXT}")).blame_output()
}

const NEXT: &str = "\
Nothing was built over the geometry of any frame. Next:

  rayflock render builtin:museum7 -o museum.gif           sixteen thousand triangles, each on its own
  rayflock render builtin:cornell --spp 16 -o cornell.png mirror and glass
  rayflock render builtin:crowd -o crowd.mp4              walking figures
  rayflock render builtin:shatter --size 800x600 -o s/    a folder of PNG pictures
  rayflock render YOUR.glb -o yours.gif                   also .obj, .ply, .stl, .aff
  rayflock info YOUR.glb                                  what is in it and what moves how
  rayflock help render                                    everything else
";
