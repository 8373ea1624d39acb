//! XML files: elements that describe arrays, whose numbers lie in them as text or base64, or
//! behind them all in one block.

mod appended;
mod array;
mod encoded;

use glam::Vec3;
use roxmltree::{Document, Node};

use super::numbers::Number;
use super::piece::{Cells, Piece, is_radius};
use crate::ImportError;
use crate::job::Job;
use appended::Appended;
use array::Arrays;

/// Reads a whole file.
pub(super) fn read(bytes: &[u8], job: &mut Job<'_>) -> Result<Piece, ImportError> {
    let (head, appended) = Appended::split(bytes, job)?;
    let text = std::str::from_utf8(&head)
        .map_err(|error| job.invalid("XML", error.to_string(), "text in UTF-8"))?;
    let document = Document::parse(text)
        .map_err(|error| job.invalid("XML", error.to_string(), "a whole XML file"))?;
    let root = document.root_element();
    if !root.has_tag_name("VTKFile") {
        let found = format!("<{}>", root.tag_name().name());
        return Err(job.invalid("XML", found, "<VTKFile>"));
    }
    let data_set = root.attribute("type").unwrap_or_default();
    if data_set != "PolyData" {
        return Err(ImportError::Unsupported {
            file: job.file.to_owned(),
            element: "<VTKFile>".to_owned(),
            found: format!("the type \"{data_set}\""),
            expected: "PolyData".to_owned(),
        });
    }
    let arrays = Arrays::new(root, appended, job)?;
    let poly_data = child(root, "PolyData")
        .ok_or_else(|| job.invalid("<VTKFile>", "no <PolyData>", "<PolyData>"))?;
    let mut whole = Piece::default();
    for (idx, node) in poly_data.children().filter(|node| node.has_tag_name("Piece")).enumerate() {
        let reader = PieceReader { node, element: format!("piece {idx}"), arrays: &arrays };
        whole.append(reader.read(job)?);
    }
    Ok(whole)
}

/// The first child of this name.
fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Reads one `<Piece>`.
struct PieceReader<'a> {
    node: Node<'a, 'a>,
    /// What messages call it.
    element: String,
    arrays: &'a Arrays<'a>,
}

impl PieceReader<'_> {
    fn read(&self, job: &Job<'_>) -> Result<Piece, ImportError> {
        let point_count = self.count("NumberOfPoints", job)?;
        let mut piece = Piece::default();
        if point_count > 0 {
            piece.points = self.vectors("Points", |_| true, point_count, job)?;
        }
        piece.polygons = self.cells("Polys", "NumberOfPolys", point_count, job)?;
        piece.strips = self.cells("Strips", "NumberOfStrips", point_count, job)?;
        piece.leave_out("lines", self.count("NumberOfLines", job)?);
        let Some(point_data) = child(self.node, "PointData") else { return Ok(piece) };
        let active = point_data.attribute("Normals").unwrap_or("Normals");
        let components =
            |node: Node<'_, '_>| node.attribute("NumberOfComponents").unwrap_or("1").to_owned();
        for node in point_data.children().filter(|node| node.has_tag_name("DataArray")) {
            let name = node.attribute("Name").unwrap_or_default();
            let place = format!("{}, point data \"{name}\"", self.element);
            if is_radius(name) && components(node) == "1" {
                piece.radii = self.arrays.numbers(node, &place, Some(point_count), job)?;
            } else if name == active && components(node) == "3" {
                piece.normals =
                    self.vectors("PointData", |other| other == node, point_count, job)?;
            }
        }
        Ok(piece)
    }

    /// An attribute that counts something; 0 where it is missing.
    fn count(&self, name: &str, job: &Job<'_>) -> Result<usize, ImportError> {
        let text = self.node.attribute(name).unwrap_or("0");
        text.trim().parse().map_err(|_| {
            job.invalid(format!("{}, {name}", self.element), format!("\"{text}\""), "a count")
        })
    }

    /// The first wanted array in the child of this name, three numbers a point.
    fn vectors(
        &self,
        parent: &str,
        is_wanted: impl Fn(Node<'_, '_>) -> bool,
        count: usize,
        job: &Job<'_>,
    ) -> Result<Vec<Vec3>, ImportError> {
        let numbers = self.array::<f32>(parent, is_wanted, Some(count.saturating_mul(3)), job)?;
        Ok(numbers.as_chunks().0.iter().map(|&vector| Vec3::from(vector)).collect())
    }

    /// The cells in the child of this name, as many as an attribute says.
    fn cells(
        &self,
        parent: &str,
        counter: &str,
        point_count: usize,
        job: &Job<'_>,
    ) -> Result<Cells, ImportError> {
        let mut cells = Cells::new(&format!("{}, {parent}", self.element));
        let count = self.count(counter, job)?;
        if count > 0 {
            let named = |wanted: &'static str| {
                move |node: Node<'_, '_>| node.attribute("Name") == Some(wanted)
            };
            let ends = self.array::<i64>(parent, named("offsets"), Some(count), job)?;
            let corners = self.array::<i64>(parent, named("connectivity"), None, job)?;
            cells.add_all(&ends, &corners, point_count, job)?;
        }
        Ok(cells)
    }

    /// The first wanted array in the child of this name, of `count` numbers where that is known.
    fn array<T: Number>(
        &self,
        parent: &str,
        is_wanted: impl Fn(Node<'_, '_>) -> bool,
        count: Option<usize>,
        job: &Job<'_>,
    ) -> Result<Vec<T>, ImportError> {
        let place = format!("{}, <{parent}>", self.element);
        let arrays = child(self.node, parent).into_iter().flat_map(|node| node.children());
        let node = arrays
            .filter(|node| node.has_tag_name("DataArray"))
            .find(|node| is_wanted(*node))
            .ok_or_else(|| job.invalid(&place, "no array", "a <DataArray> of that kind"))?;
        self.arrays.numbers(node, &place, count, job)
    }
}
