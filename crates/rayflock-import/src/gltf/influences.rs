//! The joints that vertices follow, before a node's skin says which joints these are.

use gltf::json::mesh::Semantic;
use rayflock_scene::VertexInfluences;

use super::accessor::{INDEX, Purpose, UNIT};
use super::mesh::Source;
use crate::ImportError;
use crate::job::Job;

/// Sets of four joints that are read; vertices follow at most eight joints.
const JOINT_SETS: u32 = 2;

impl Source<'_> {
    /// Joints and shares of each vertex, the shares summing to 1.
    pub(super) fn influences(
        &self,
        vertex_count: usize,
        job: &mut Job<'_>,
    ) -> Result<Option<Vec<VertexInfluences>>, ImportError> {
        if self.accessor(&Semantic::Joints(0)).is_none()
            || self.accessor(&Semantic::Weights(0)).is_none()
        {
            return Ok(None);
        }
        if self.accessor(&Semantic::Joints(JOINT_SETS)).is_some() {
            job.warn(&self.element, "vertices follow more than 8 joints; the others are left out");
        }
        let mut influences = vec![VertexInfluences::default(); vertex_count];
        for set in 0..JOINT_SETS {
            self.add_joint_set(set, &mut influences)?;
        }
        self.normalise(&mut influences, job)?;
        Ok(Some(influences))
    }

    fn add_joint_set(
        &self,
        set: u32,
        influences: &mut [VertexInfluences],
    ) -> Result<(), ImportError> {
        let count = Some(influences.len());
        let weights = self.attribute::<4>(&Semantic::Weights(set), UNIT, count)?;
        let joints = self.accessor(&Semantic::Joints(set));
        let (Some(weights), Some(joints)) = (weights, joints) else { return Ok(()) };
        let element = format!("{} JOINTS_{set}", self.element);
        // All but 32-bit integers, which glTF does not allow here.
        let purpose = Purpose { element: &element, components: &INDEX[..2], count };
        let joints = self.accessors.integers::<4>(joints, purpose)?;
        let first = 4 * set as usize;
        for ((influence, joints), weights) in influences.iter_mut().zip(joints).zip(weights) {
            // Purposes allow at most 16 bits.
            influence.joints[first..first + 4].copy_from_slice(&joints.map(|joint| joint as u16));
            influence.weights[first..first + 4].copy_from_slice(&weights);
        }
        Ok(())
    }

    fn normalise(
        &self,
        influences: &mut [VertexInfluences],
        job: &mut Job<'_>,
    ) -> Result<(), ImportError> {
        let mut loose_count = 0;
        for (vertex_idx, influence) in influences.iter_mut().enumerate() {
            let sum: f32 = influence.weights.iter().sum();
            if !sum.is_finite() || influence.weights.iter().any(|&weight| weight < 0.0) {
                let element = format!("{} WEIGHTS vertex {vertex_idx}", self.element);
                let found = format!("{:?}", influence.weights);
                return Err(job.invalid(element, found, "finite weights, 0 or more"));
            }
            if sum > 0.0 {
                influence.weights.iter_mut().for_each(|weight| *weight /= sum);
            } else {
                *influence = VertexInfluences::default();
                influence.weights[0] = 1.0;
                loose_count += 1;
            }
        }
        if loose_count > 0 {
            let message = format!("{loose_count} vertices follow no joint; they follow the first");
            job.warn(&self.element, message);
        }
        Ok(())
    }
}
