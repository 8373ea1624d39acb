// What is asked about each ray: 0 for the closest hit, this for any.
const QUESTION_OCCLUDED: u32 = 1u;
