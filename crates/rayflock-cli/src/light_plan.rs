//! From what is asked about light to how a frame is rendered.

#[cfg(feature = "bench")]
use anyhow::Context;
use anyhow::{Result, ensure};
use rayflock::engine::RayEngine;
#[cfg(feature = "bench")]
use rayflock::render::RenderSettings;
use rayflock::render::caustics::CausticSettings;
use rayflock::render::lightcuts::CutSettings;
use rayflock::render::occluders::SphereSettings;
use rayflock::render::vpl::{ChosenBy, ChosenRays, LookoutSettings, Visibility, VplSettings};
use rayflock::render::{FrameRenderer, Indirect, PathTracer, Shown, WhittedRenderer};

use crate::args::{
    ChoiceArgument, IndirectArgument, Integrator, LightArguments, VisibilityArgument,
};

/// Turns that paths take at most: light fades long before.
const PATH_DEPTH: u32 = 32;
/// Samples a pixel of paths: enough to see what is there.
const PATH_SAMPLES: u32 = 64;

impl Integrator {
    /// A renderer of this kind that traces with `engine`.
    pub(crate) fn renderer(self, engine: Box<dyn RayEngine>) -> Box<dyn FrameRenderer> {
        match self {
            Self::Whitted => Box::new(WhittedRenderer::new(engine)),
            Self::Path => Box::new(PathTracer::new(engine)),
        }
    }

    /// Turns and samples a pixel where none are asked for.
    pub(crate) const fn default_depth_and_samples(self) -> (u32, u32) {
        match self {
            Self::Whitted => (5, 1),
            Self::Path => (PATH_DEPTH, PATH_SAMPLES),
        }
    }

    /// The name on the command line.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Whitted => "whitted",
            Self::Path => "path",
        }
    }
}

impl IndirectArgument {
    /// The name on the command line.
    const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Vpl => "vpl",
            Self::Lightcuts => "lightcuts",
        }
    }
}

/// How indirect light is found, if what is asked fits together.
pub(crate) fn plan_indirect(args: &LightArguments) -> Result<Indirect> {
    let defaults = VplSettings::default();
    let of_vpls = [
        ("--vpls", args.vpls.is_some()),
        ("--visibility", args.visibility.is_some()),
        ("--vpl-rays", args.vpl_rays.is_some()),
        ("--vpl-bound", args.vpl_bound.is_some()),
        ("--spheres", args.spheres.is_some()),
        ("--lookout-points", args.lookout_points.is_some()),
        ("--error-bound", args.error_bound.is_some()),
    ];
    check_view(args)?;
    match args.indirect {
        IndirectArgument::Off => {
            for (option, is_there) in of_vpls {
                ensure!(!is_there, "{option} is about virtual lights: it needs --indirect vpl");
            }
            Ok(Indirect::Off)
        }
        IndirectArgument::Vpl | IndirectArgument::Lightcuts => {
            ensure!(
                args.integrator == Integrator::Whitted,
                "--indirect {} needs --integrator whitted: path finds such light by itself",
                args.indirect.name()
            );
            let visibility = plan_visibility(args)?;
            let lights = VplSettings {
                light_count: args.vpls.unwrap_or(defaults.light_count),
                visibility,
                chosen: args.vpl_rays.map(|count| ChosenRays { count, by: chosen_by(args) }),
                bound: args.vpl_bound.unwrap_or(defaults.bound),
            };
            plan_cuts(args, lights)
        }
    }
}

/// What points see of virtual lights, if what is asked fits together.
fn plan_visibility(args: &LightArguments) -> Result<Visibility> {
    let visibility = match args.visibility {
        None | Some(VisibilityArgument::Exact) => Visibility::Exact,
        Some(VisibilityArgument::None) => Visibility::None,
        Some(VisibilityArgument::Spheres) => Visibility::Spheres(spheres(args)),
        Some(VisibilityArgument::Lookouts) => Visibility::Lookouts(lookouts(args)),
    };
    ensure!(
        args.spheres.is_none() || matches!(visibility, Visibility::Spheres(_)),
        "--spheres needs --visibility spheres"
    );
    let has_lookouts = matches!(visibility, Visibility::Lookouts(_));
    ensure!(
        args.lookout_points.is_none() || has_lookouts,
        "--lookout-points needs --visibility lookouts"
    );
    let asks_all = args.indirect == IndirectArgument::Vpl && args.vpl_rays.is_none();
    ensure!(
        !has_lookouts || asks_all,
        "--visibility lookouts needs --indirect vpl without --vpl-rays: neighbours share rays only \
         to lights that all of them ask about"
    );
    Ok(visibility)
}

/// How light is found that mirrors and glass throw, if it is asked for.
pub(crate) fn plan_caustics(args: &LightArguments) -> Result<Option<CausticSettings>> {
    let Some(photons) = args.caustics else { return Ok(None) };
    ensure!(
        args.integrator == Integrator::Whitted,
        "--caustics needs --integrator whitted: path finds no such light of lamps"
    );
    let radius = args.caustic_radius.unwrap_or(CausticSettings::default().radius);
    Ok(Some(CausticSettings { photons, radius }))
}

/// What pictures are compared with to tell their error, if that is asked for.
#[cfg(feature = "bench")]
pub(crate) fn plan_comparison(
    args: &LightArguments,
    settings: &RenderSettings,
) -> Result<Option<RenderSettings>> {
    if !args.check_error {
        return Ok(None);
    }
    let exact = settings.indirect.exact().context(
        "--check-error compares with a shadow ray to every virtual light: it needs --indirect \
         lightcuts, or --indirect vpl with --visibility spheres, lookouts or none, or --vpl-rays",
    )?;
    Ok(Some(RenderSettings { indirect: exact, ..settings.clone() }))
}

/// All lights, or clusters of them.
fn plan_cuts(args: &LightArguments, lights: VplSettings) -> Result<Indirect> {
    if args.indirect == IndirectArgument::Vpl {
        ensure!(args.error_bound.is_none(), "--error-bound needs --indirect lightcuts");
        return Ok(Indirect::Vpl(lights));
    }
    ensure!(lights.chosen.is_none(), "--vpl-rays needs --indirect vpl: cuts choose lights already");
    let error_bound = args.error_bound.unwrap_or(CutSettings::default().error_bound);
    Ok(Indirect::Lightcuts { lights, error_bound })
}

fn spheres(args: &LightArguments) -> SphereSettings {
    let default = SphereSettings::default();
    SphereSettings { count: args.spheres.map_or(default.count, |count| count as usize) }
}

fn lookouts(args: &LightArguments) -> LookoutSettings {
    let default = LookoutSettings::default();
    LookoutSettings { points: args.lookout_points.map_or(default.points, |points| points as usize) }
}

/// Only what is rendered can be shown.
fn check_view(args: &LightArguments) -> Result<()> {
    let view = args.view;
    if view != Shown::Light {
        ensure!(
            args.integrator == Integrator::Whitted,
            "--view {view} needs --integrator whitted: path shows nothing but light"
        );
    }
    if view == Shown::Spheres {
        ensure!(
            args.visibility == Some(VisibilityArgument::Spheres),
            "--view {view} shows what stands for the geometry: it needs --visibility spheres"
        );
    }
    if matches!(view, Shown::Indirect | Shown::Vpls) {
        ensure!(
            args.indirect != IndirectArgument::Off,
            "--view {view} is about virtual lights: it needs --indirect vpl"
        );
    }
    Ok(())
}

fn chosen_by(args: &LightArguments) -> ChosenBy {
    match args.vpl_choice {
        Some(ChoiceArgument::Uniform) => ChosenBy::Uniform,
        Some(ChoiceArgument::Difference) => ChosenBy::Difference,
        None | Some(ChoiceArgument::Weight) => ChosenBy::Weight,
    }
}

/// What decides about light that is thrown, in words.
pub(crate) fn caustics_text(caustics: Option<&CausticSettings>) -> String {
    caustics.map_or_else(
        || "off".to_owned(),
        |CausticSettings { photons, radius }| format!("{photons}, radius {radius}"),
    )
}

/// What decides about indirect light, in words.
pub(crate) fn indirect_text(indirect: &Indirect) -> String {
    match indirect {
        Indirect::Vpl(VplSettings { light_count, visibility, bound, chosen }) => {
            let rays = chosen.map_or_else(
                || "all rays".to_owned(),
                |chosen| format!("{} rays by {:?}", chosen.count, chosen.by),
            );
            format!("vpl, {light_count} lights, visibility {visibility:?}, {rays}, bound {bound}")
        }
        Indirect::Lightcuts {
            lights: VplSettings { light_count, visibility, bound, .. },
            error_bound,
        } => {
            format!(
                "lightcuts, {light_count} lights, visibility {visibility:?}, bound {bound}, \
                 error bound {error_bound}"
            )
        }
        _ => "off".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        light: LightArguments,
    }

    fn planned(line: &str) -> Result<Indirect> {
        let words = std::iter::once("rayflock").chain(line.split_whitespace());
        plan_indirect(&Line::try_parse_from(words)?.light)
    }

    #[test]
    fn what_is_asked_of_virtual_lights_is_what_is_rendered() {
        assert_eq!(planned("").unwrap(), Indirect::Off);
        assert_eq!(planned("--indirect vpl").unwrap(), Indirect::Vpl(VplSettings::default()));
        let asked = planned("--indirect vpl --vpls 7 --visibility none --vpl-bound inf").unwrap();
        let (visibility, bound) = (Visibility::None, f32::INFINITY);
        let expected = VplSettings { light_count: 7, visibility, bound, chosen: None };
        assert_eq!(asked, Indirect::Vpl(expected));
        let few = planned("--indirect vpl --vpl-rays 4 --vpl-choice difference").unwrap();
        let chosen = Some(ChosenRays { count: 4, by: ChosenBy::Difference });
        assert_eq!(few, Indirect::Vpl(VplSettings { chosen, ..VplSettings::default() }));
        let visibility = Visibility::Spheres(SphereSettings { count: 99 });
        let lights = VplSettings { visibility, ..VplSettings::default() };
        let line = "--visibility spheres --spheres 99";
        assert_eq!(planned(&format!("--indirect vpl {line}")).unwrap(), Indirect::Vpl(lights));
        let visibility = Visibility::Lookouts(LookoutSettings { points: 16 });
        let line = "--indirect vpl --visibility lookouts --lookout-points 16";
        let expected = VplSettings { visibility, ..VplSettings::default() };
        assert_eq!(planned(line).unwrap(), Indirect::Vpl(expected));
        let line = "--visibility spheres --spheres 99";
        let cuts = planned(&format!("--indirect lightcuts --error-bound 0.1 {line}")).unwrap();
        assert_eq!(cuts, Indirect::Lightcuts { lights, error_bound: 0.1 });
    }

    #[test]
    fn light_that_is_thrown_is_planned_as_asked() {
        let planned = |line: &str| {
            let words = std::iter::once("rayflock").chain(line.split_whitespace());
            plan_caustics(&Line::try_parse_from(words)?.light)
        };
        assert_eq!(planned("").unwrap(), None);
        let expected = CausticSettings { photons: 5000, ..CausticSettings::default() };
        assert_eq!(planned("--caustics 5000").unwrap(), Some(expected));
        let wide = planned("--caustics 5000 --caustic-radius 0.05").unwrap();
        assert_eq!(wide, Some(CausticSettings { radius: 0.05, ..expected }));
        assert_eq!(caustics_text(wide.as_ref()), "5000, radius 0.05");
        for wrong in ["--caustics 5", "--caustic-radius 0.1", "--caustics 99 --caustic-radius 2"] {
            assert!(planned(wrong).is_err(), "{wrong}");
        }
        let by_paths = planned("--caustics 99 --integrator path").unwrap_err().to_string();
        assert!(by_paths.contains("--integrator whitted"), "{by_paths}");
    }

    #[test]
    fn errors_are_told_of_what_is_approximate() {
        let compared = |line: &str| {
            let words = std::iter::once("rayflock").chain(line.split_whitespace());
            let light = Line::try_parse_from(words).unwrap().light;
            let indirect = plan_indirect(&light).unwrap();
            plan_comparison(&light, &RenderSettings { indirect, ..RenderSettings::default() })
        };
        assert_eq!(compared("--indirect vpl --visibility spheres").unwrap(), None);
        for light in ["vpl --visibility spheres", "vpl --vpl-rays 2", "lightcuts"] {
            let settings = compared(&format!("--indirect {light} --vpls 7 --check-error")).unwrap();
            let lights = VplSettings { light_count: 7, ..VplSettings::default() };
            assert_eq!(settings.unwrap().indirect, Indirect::Vpl(lights));
        }
        for light in ["off", "vpl"] {
            let error = compared(&format!("--indirect {light} --check-error")).unwrap_err();
            assert!(error.to_string().contains("it needs --indirect lightcuts"), "{error}");
        }
    }

    #[test]
    fn what_does_not_fit_together_is_told() {
        let error = planned("--vpls 7").unwrap_err().to_string();
        assert_eq!(error, "--vpls is about virtual lights: it needs --indirect vpl");
        for asked in ["--indirect vpl", "--indirect lightcuts"] {
            let error = planned(&format!("--integrator path {asked}")).unwrap_err().to_string();
            let expected = format!("{asked} needs --integrator whitted");
            assert!(error.starts_with(&expected), "{error}");
        }
        assert!(planned("--indirect vpl --vpl-bound -1").is_err());
        for light in ["vpl --vpl-rays 2", "lightcuts"] {
            let line = format!("--indirect {light} --visibility lookouts");
            let error = planned(&line).unwrap_err().to_string();
            assert!(error.contains("needs --indirect vpl without --vpl-rays"), "{error}");
        }
        let error = planned("--indirect vpl --lookout-points 9").unwrap_err().to_string();
        assert_eq!(error, "--lookout-points needs --visibility lookouts");
        let error = planned("--indirect vpl --spheres 9").unwrap_err().to_string();
        assert_eq!(error, "--spheres needs --visibility spheres");
        let error = planned("--indirect vpl --error-bound 0.1").unwrap_err().to_string();
        assert_eq!(error, "--error-bound needs --indirect lightcuts");
        assert!(planned("--indirect lightcuts --error-bound 2").is_err());
        let error = planned("--indirect lightcuts --vpl-rays 4").unwrap_err().to_string();
        assert!(error.starts_with("--vpl-rays needs --indirect vpl"), "{error}");
        let error = planned("--view vpls").unwrap_err().to_string();
        assert_eq!(error, "--view vpls is about virtual lights: it needs --indirect vpl");
        let error = planned("--view spheres --indirect vpl").unwrap_err().to_string();
        assert!(error.ends_with("it needs --visibility spheres"), "{error}");
        let error = planned("--view depth --integrator path").unwrap_err().to_string();
        assert!(error.contains("path shows nothing but light"), "{error}");
    }
}
