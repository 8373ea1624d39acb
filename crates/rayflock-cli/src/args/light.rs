//! Which light is found, and how.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use rayflock::render::Shown;

/// How light is found.
#[derive(Clone, Debug, Args)]
pub(crate) struct LightArguments {
    /// What a picture is made of: whitted follows mirrors and glass and asks lights, without
    /// noise; path finds all light by chance, and the more --spp, the less noise.
    ///
    /// path is for judging the other, or for a last picture: what whitted renders in a second may
    /// take it minutes. Both need no setting up when everything moves.
    #[arg(long, value_name = "NAME", default_value = "whitted")]
    pub(crate) integrator: Integrator,

    /// How whitted finds light that comes from other surfaces and the sky: off lets ambient light
    /// stand for it; vpl gathers it from virtual lights, which walks from the lights leave where
    /// they hit; lightcuts lets one of these speak for many where --error-bound allows, for tens of
    /// thousands of them.
    ///
    /// Virtual lights stay where they are while nothing on their way moves, so films do not
    /// flicker there. Light that mirrors and glass throw onto rough surfaces is what --caustics is
    /// for.
    #[arg(long, value_name = "NAME", default_value = "off")]
    pub(crate) indirect: IndirectArgument,

    /// About how many virtual lights there are: fewer show as blotches and hard shadows, more
    /// take as much longer [default: 1024].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1_048_576))]
    pub(crate) vpls: Option<u32>,

    /// What points see of virtual lights: exact traces a shadow ray for each pair of both, spheres
    /// asks spheres that stand for the geometry, several times sooner and nearly right, lookouts
    /// traces a shadow ray for up to 32 neighbours at once, about as soon and nearer to what is
    /// right, none traces nothing and lets light leak through walls [default: exact].
    #[arg(long, value_name = "NAME")]
    pub(crate) visibility: Option<VisibilityArgument>,

    /// About how many spheres stand for the scene, for --visibility spheres: more are nearer to
    /// what is exact, and take longer [default: 512].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub(crate) spheres: Option<u32>,

    /// How many neighbours share a shadow ray at most, for --visibility lookouts, 1, 4, 16, 32 or
    /// 64: fewer are nearer to what is exact, and take longer [default: 32].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) lookout_points: Option<u32>,

    /// The share of the light at a point that one virtual light may be wrong by as it speaks for
    /// others, for --indirect lightcuts, from 0 to 1 [default: 0.02].
    #[arg(long, value_name = "X", value_parser = parse_share)]
    pub(crate) error_bound: Option<f32>,

    /// Trace so many shadow rays a point instead of one to each virtual light: noise in place of
    /// time, which --spp takes away; in the mean it is the same picture.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) vpl_rays: Option<u32>,

    /// To which virtual lights --vpl-rays go: weight, those that are likely to send most;
    /// difference, those that correct a guess of all most; uniform, any, to compare with
    /// [default: weight].
    #[arg(long, value_name = "NAME", requires = "vpl_rays")]
    pub(crate) vpl_choice: Option<ChoiceArgument>,

    /// Find the light that mirrors and glass throw onto rough surfaces, by about N rays from each
    /// point, spot and directional light: fewer show as blotches, 65536 is a good number to begin
    /// with. Surfaces that emit throw none.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(64..=4_194_304))]
    pub(crate) caustics: Option<u32>,

    /// From how far around a point such light is gathered, as a share of the diagonal of the scene,
    /// from 0.00001 to 0.5: wider is smoother and blurs more [default: 0.01].
    #[arg(long, value_name = "X", requires = "caustics", value_parser = parse_radius)]
    pub(crate) caustic_radius: Option<f32>,

    /// What pixels tell: light; normals or depth of what is seen first; cost, the rays traced for
    /// them, white for 32 a sample; indirect, light from virtual lights alone; vpls, where those
    /// are; spheres, what stands for the geometry with --visibility spheres.
    #[arg(long, value_name = "NAME", default_value = "light", value_parser = shown())]
    pub(crate) view: Shown,

    /// Render each frame once more with a shadow ray to every virtual light, and tell how far the
    /// picture is from that: by mean FLIP, which is 0 where the eye sees no difference, and by root
    /// mean squared error of the radiance over its root mean square. Takes the time of both.
    #[cfg(feature = "bench")]
    #[arg(long)]
    pub(crate) check_error: bool,

    /// How bright a virtual light may show close by: less takes bright spots out of corners, and
    /// some light with them; --stats tells how much (clamped). inf takes nothing [default: 1].
    #[arg(long, value_name = "X", value_parser = parse_bound)]
    pub(crate) vpl_bound: Option<f32>,
}

/// What a picture is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Integrator {
    /// Mirrors, glass and direct light.
    Whitted,
    /// All light, by chance.
    Path,
}

/// How light from other surfaces is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum IndirectArgument {
    /// Ambient light stands for it.
    Off,
    /// From virtual lights.
    Vpl,
    /// From clusters of them.
    Lightcuts,
}

/// Which virtual lights get a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChoiceArgument {
    /// Any.
    Uniform,
    /// Those that are likely to send most.
    Weight,
    /// Those that correct a guess most.
    Difference,
}

/// What points see of virtual lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum VisibilityArgument {
    /// A shadow ray each.
    Exact,
    /// Past spheres that stand for geometry.
    Spheres,
    /// A shadow ray for neighbours.
    Lookouts,
    /// Everything.
    None,
}

fn shown() -> impl TypedValueParser<Value = Shown> {
    PossibleValuesParser::new(Shown::ALL.map(Shown::name))
        .map(|name| Shown::ALL.into_iter().find(|shown| shown.name() == name).unwrap_or_default())
}

fn parse_share(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a number from 0 to 1, such as 0.02".to_owned()),
    }
}

fn parse_radius(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(radius) if (1e-5..=0.5).contains(&radius) => Ok(radius),
        _ => Err("expected a number from 0.00001 to 0.5, such as 0.01".to_owned()),
    }
}

fn parse_bound(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(bound) if bound >= 0.0 => Ok(bound),
        _ => Err("expected a number from 0, such as 0.5, or inf".to_owned()),
    }
}
