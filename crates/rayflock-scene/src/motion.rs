//! How objects move, in kinds.

/// How an object changes over a clip, from least to most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MotionKind {
    /// Not at all.
    #[default]
    Static,
    /// As a whole: the same mesh at other places.
    Rigid,
    /// Vertices move, triangles stay.
    Deforming,
    /// Anything may change.
    Topology,
}
