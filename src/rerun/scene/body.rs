//! Poses of the drawn tops.

use rerun::archetypes::Transform3D;

use crate::rerun::output::ComponentColumns;

/// Translation and quaternion, from body to world.
pub(in crate::rerun) type BodyPose = ([f32; 3], [f32; 4]);

/// The transforms of a body.
pub(in crate::rerun) fn body_columns(rows: &[BodyPose]) -> ComponentColumns {
    let quaternions = rows.iter().map(|(_, quaternion)| *quaternion);
    let transform = Transform3D::update_fields()
        .with_many_translation(rows.iter().map(|(translation, _)| *translation))
        .with_many_quaternion(quaternions.map(rerun::Quaternion::from_xyzw));
    Ok(transform.columns_of_unit_batches()?.collect())
}
