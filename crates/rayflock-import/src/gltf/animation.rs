//! Clips: keyframes of nodes, checked so that sampling them needs no further care.

use glam::{Quat, Vec3};
use gltf::json::animation::{
    Animation, Channel as JsonChannel, Interpolation as JsonInterpolation,
};
use gltf::json::animation::{Property, Sampler};
use gltf::json::validation::Checked;
use rayflock_scene::{Channel, ChannelValues, Clip, Interpolation, LocalTransform, Node, NodeIdx};

use super::accessor::{Accessors, FLOAT, Purpose, SIGNED_UNIT};
use super::label;
use crate::ImportError;
use crate::job::Job;

/// Reads the clips. A node with a matrix that a clip moves gets its matrix taken apart.
pub(super) fn load(
    accessors: &Accessors<'_>,
    nodes: &mut [Node],
    job: &mut Job<'_>,
) -> Result<Vec<Clip>, ImportError> {
    let mut clips = Vec::new();
    for (idx, animation) in accessors.root.animations.iter().enumerate() {
        let element = label("animation", idx, animation.name.as_ref());
        let mut channels = Vec::new();
        for (channel_idx, channel) in animation.channels.iter().enumerate() {
            let element = format!("{element} channel {channel_idx}");
            let source = Source { accessors, animation, json: channel, element };
            if let Some(channel) = source.load(nodes, job)? {
                take_apart(&mut nodes[channel.node.0 as usize], &source.element, job);
                channels.push(channel);
            }
        }
        let name = animation.name.clone().filter(|name| !name.is_empty());
        clips.push(Clip { name: name.unwrap_or_else(|| format!("clip{idx}")), channels });
    }
    Ok(clips)
}

/// Makes a matrix into parts, which clips can replace.
fn take_apart(node: &mut Node, element: &str, job: &mut Job<'_>) {
    if let LocalTransform::Matrix(matrix) = node.rest {
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        node.rest = LocalTransform::Parts { translation, rotation, scale };
        job.warn(element, "the node has a matrix; it is taken apart, and shear is lost");
    }
}

/// A channel being read.
struct Source<'a> {
    accessors: &'a Accessors<'a>,
    animation: &'a Animation,
    json: &'a JsonChannel,
    element: String,
}

impl Source<'_> {
    /// `None` for what cannot be played, with a warning.
    fn load(&self, nodes: &[Node], job: &mut Job<'_>) -> Result<Option<Channel>, ImportError> {
        let target = &self.json.target;
        let node_idx = target.node.value();
        if node_idx >= nodes.len() {
            let expected = format!("one of {} nodes", nodes.len());
            return Err(job.invalid(&self.element, format!("node {node_idx}"), expected));
        }
        let target_count = nodes[node_idx].rest_weights.len();
        let sampler = &self.animation.samplers[self.json.sampler.value()];
        let (property, interpolation) = match (target.path, sampler.interpolation) {
            (Checked::Valid(Property::MorphTargetWeights), _) if target_count == 0 => {
                job.warn(&self.element, "the node has no morph targets; the channel is left out");
                return Ok(None);
            }
            (Checked::Valid(property), Checked::Valid(kind)) => (property, interpolation(kind)),
            _ => {
                job.warn(&self.element, "what moves or how is unknown; the channel is left out");
                return Ok(None);
            }
        };
        let mut times = self.times(sampler, job)?;
        let values_per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let value_count = times.len() * values_per_key;
        let mut values = self.values(sampler, property, value_count, target_count, job)?;
        self.drop_disorder(&mut times, &mut values, values_per_key, job);
        if times.is_empty() {
            job.warn(&self.element, "there are no keys; the channel is left out");
            return Ok(None);
        }
        self.normalise(&mut values, interpolation, job)?;
        let node = NodeIdx(node_idx as u32);
        Ok(Some(Channel { node, times, interpolation, values }))
    }

    fn times(&self, sampler: &Sampler, job: &Job<'_>) -> Result<Vec<f32>, ImportError> {
        let element = format!("{} input", self.element);
        let purpose = Purpose { element: &element, components: FLOAT, count: None };
        let times = self.accessors.floats(sampler.input, purpose)?;
        let times: Vec<f32> = times.into_iter().map(|[time]| time).collect();
        match times.iter().find(|time| !time.is_finite()) {
            None => Ok(times),
            Some(time) => Err(job.invalid(element, format!("the time {time}"), "finite times")),
        }
    }

    fn values(
        &self,
        sampler: &Sampler,
        property: Property,
        count: usize,
        target_count: usize,
        job: &Job<'_>,
    ) -> Result<ChannelValues, ImportError> {
        let element = format!("{} output", self.element);
        let purpose = |components, count| Purpose { element: &element, components, count };
        let (accessors, output) = (self.accessors, sampler.output);
        let vectors = || {
            let values = accessors.floats(output, purpose(FLOAT, Some(count)))?;
            Ok(values.into_iter().map(Vec3::from_array).collect::<Vec<_>>())
        };
        let values = match property {
            Property::Translation => ChannelValues::Translation(vectors()?),
            Property::Scale => ChannelValues::Scale(vectors()?),
            Property::Rotation => {
                let values = accessors.floats(output, purpose(SIGNED_UNIT, Some(count)))?;
                ChannelValues::Rotation(values.into_iter().map(Quat::from_array).collect())
            }
            Property::MorphTargetWeights => {
                let count = Some(count * target_count);
                let values = accessors.floats(output, purpose(SIGNED_UNIT, count))?;
                let values = values.into_iter().map(|[weight]| weight).collect();
                ChannelValues::Weights { weights_per_key: target_count, values }
            }
        };
        let finite = match &values {
            ChannelValues::Translation(values) | ChannelValues::Scale(values) => {
                values.iter().all(|value| value.is_finite())
            }
            ChannelValues::Rotation(values) => values.iter().all(|value| value.is_finite()),
            ChannelValues::Weights { values, .. } => values.iter().all(|value| value.is_finite()),
            ChannelValues::Visibility(_) => true,
        };
        match finite {
            true => Ok(values),
            false => Err(job.invalid(element, "numbers that are not finite", "finite numbers")),
        }
    }

    /// Leaves out keys that are not later than the one before.
    fn drop_disorder(
        &self,
        times: &mut Vec<f32>,
        values: &mut ChannelValues,
        values_per_key: usize,
        job: &mut Job<'_>,
    ) {
        let mut last = f32::NEG_INFINITY;
        let keep: Vec<bool> = times
            .iter()
            .map(|&time| {
                time > last && {
                    last = time;
                    true
                }
            })
            .collect();
        let dropped = keep.iter().filter(|&&keep| !keep).count();
        if dropped == 0 {
            return;
        }
        retain(times, &keep, 1);
        match values {
            ChannelValues::Translation(values) | ChannelValues::Scale(values) => {
                retain(values, &keep, values_per_key);
            }
            ChannelValues::Rotation(values) => retain(values, &keep, values_per_key),
            ChannelValues::Weights { weights_per_key, values } => {
                retain(values, &keep, values_per_key * *weights_per_key);
            }
            ChannelValues::Visibility(values) => retain(values, &keep, 1),
        }
        let message =
            format!("{dropped} keys are not later than the key before; they are left out");
        job.warn(&self.element, message);
    }

    /// Gives rotations unit length; the tangents of splines have none.
    fn normalise(
        &self,
        values: &mut ChannelValues,
        interpolation: Interpolation,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        let ChannelValues::Rotation(rotations) = values else { return Ok(()) };
        let (first, step) =
            if interpolation == Interpolation::CubicSpline { (1, 3) } else { (0, 1) };
        for rotation in rotations.iter_mut().skip(first).step_by(step) {
            let unit = rotation.normalize();
            if !unit.is_finite() {
                let found = format!("the rotation {rotation}");
                return Err(job.invalid(&self.element, found, "quaternions of unit length"));
            }
            *rotation = unit;
        }
        Ok(())
    }
}

fn interpolation(kind: JsonInterpolation) -> Interpolation {
    match kind {
        JsonInterpolation::Linear => Interpolation::Linear,
        JsonInterpolation::Step => Interpolation::Step,
        JsonInterpolation::CubicSpline => Interpolation::CubicSpline,
    }
}

/// Keeps the groups of `group_size` values that `keep` says.
fn retain<T>(values: &mut Vec<T>, keep: &[bool], group_size: usize) {
    let mut idx = 0;
    values.retain(|_| {
        let kept = keep[idx / group_size];
        idx += 1;
        kept
    });
}
