//! The room that the moving triangles are in: a box of square cells, with a hole in its ceiling.
//!
//! The floor lies at height 0, its middle at the origin. The corners of cells at which two sides
//! meet agree in every bit, so that no ray leaves but through the skylight.

use rayflock::geom::Mesh;
use rayflock::prelude::Vec3;

use super::definition::Room;

/// The room as two triangles a cell.
pub(super) fn build(room: &Room) -> Mesh {
    let [columns, rows, depth] = room.cells;
    let mut grid = Grid { room, vertices: Vec::new(), triangles: Vec::new() };
    let skylight = |cells: usize| {
        let first = (cells - room.skylight) / 2;
        first..first + room.skylight
    };
    let (hole_x, hole_z) = (skylight(columns), skylight(depth));
    grid.side([columns, depth], |x, z| [x, 0, z], |_, _| true);
    let is_closed = |x, z| !(hole_x.contains(&x) && hole_z.contains(&z));
    grid.side([columns, depth], |x, z| [x, rows, z], is_closed);
    for z in [0, depth] {
        grid.side([columns, rows], |x, y| [x, y, z], |_, _| true);
    }
    for x in [0, columns] {
        grid.side([depth, rows], |z, y| [x, y, z], |_, _| true);
    }
    let Ok(mesh) = Mesh::from_triangles(grid.vertices, grid.triangles) else {
        unreachable!("sides name only vertices that they have added")
    };
    mesh
}

/// Sides in the making.
struct Grid<'a> {
    room: &'a Room,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Grid<'_> {
    /// Adds a side of `columns` times `rows` cells, without those that are not `closed`.
    /// `place` tells which corner of the room's cells a corner of the side is.
    fn side(
        &mut self,
        [columns, rows]: [usize; 2],
        place: impl Fn(usize, usize) -> [usize; 3],
        closed: impl Fn(usize, usize) -> bool,
    ) {
        let first = self.vertices.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                self.vertices.push(self.corner(place(column, row)));
            }
        }
        let stride = columns as u32 + 1;
        for row in 0..rows {
            for column in (0..columns).filter(|&column| closed(column, row)) {
                let a = first + row as u32 * stride + column as u32;
                let [b, c, d] = [a + 1, a + 1 + stride, a + stride];
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    fn corner(&self, at: [usize; 3]) -> Vec3 {
        let share = |axis: usize| at[axis] as f32 / self.room.cells[axis] as f32;
        let [x, y, z] = self.room.size;
        Vec3::new(x * (share(0) - 0.5), y * share(1), z * (share(2) - 0.5))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    fn small() -> Room {
        Room { size: [3.0, 2.0, 4.0], cells: [7, 3, 5], skylight: 3 }
    }

    #[test]
    fn the_room_of_the_map_has_the_stated_number_of_triangles() {
        let definition = super::super::Definition::default_map();
        assert_eq!(build(&definition.room).triangles().len(), 9_952);
    }

    #[test]
    fn it_is_closed_but_for_the_skylight() {
        let mesh = build(&small());
        let bits = |vertex: u32| mesh.vertices()[vertex as usize].to_array().map(f32::to_bits);
        let mut edges = HashMap::new();
        for corners in mesh.triangles() {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let mut edge = [bits(corners[from]), bits(corners[to])];
                edge.sort_unstable();
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|&count| count <= 2));
        let open: Vec<_> = edges.iter().filter(|&(_, &count)| count == 1).collect();
        assert_eq!(open.len(), 4 * 3);
        for ([from, to], _) in open {
            assert!([from, to].iter().all(|corner| corner[1] == 2.0_f32.to_bits()));
        }
    }

    #[test]
    fn it_stands_on_the_floor_around_the_origin() {
        let bounds = build(&small()).bounds();
        assert_eq!(bounds.min, Vec3::new(-1.5, 0.0, -2.0));
        assert_eq!(bounds.max, Vec3::new(1.5, 2.0, 2.0));
    }
}
