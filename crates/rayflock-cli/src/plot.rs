//! The first paper's graph: update and render time of each frame.
//!
//! **Source.** The figure of Khanna, Mortensen, Yu and Slater, "A Visibility Field for Ray
//! Tracing", CGIV 2007: update time stays level and low while render time follows the picture.
//! **Departures.** The text of an SVG is left to the viewer's fonts. An HTML file is the same
//! SVG with the numbers in words, so that neither needs a script or a network.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use plotters::coord::types::{RangedCoordf64, RangedCoordu32};
use plotters::prelude::*;

use crate::output::atomic;
use crate::stats::{FrameRecord, Stats};

/// Width and height of the graph, in pixels.
const SIZE: (u32, u32) = (960, 540);

const UPDATE_COLOR: RGBColor = RGBColor(0xd9, 0x5f, 0x02);
const RENDER_COLOR: RGBColor = RGBColor(0x1b, 0x6c, 0xa8);

/// A graph to be written.
#[derive(Clone, Debug)]
pub(crate) struct PlotFile {
    path: PathBuf,
    format: PlotFormat,
}

#[derive(Clone, Copy, Debug)]
enum PlotFormat {
    Svg,
    Html,
}

impl PlotFile {
    /// Understands `path` by its extension.
    pub(crate) fn new(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = match extension.as_str() {
            "svg" => PlotFormat::Svg,
            "html" => PlotFormat::Html,
            _ => bail!("cannot draw \"{}\": expected a .svg or .html file", path.display()),
        };
        Ok(Self { path: path.to_owned(), format })
    }

    /// Where the graph goes.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Draws the frames of `stats`.
    pub(crate) fn write(&self, stats: &Stats) -> Result<()> {
        let mut text = draw(stats).context("cannot draw the graph")?;
        if let PlotFormat::Html = self.format {
            text = page(stats, &text);
        }
        atomic::write_whole(&self.path, |partial| Ok(fs::write(partial, text)?))
    }
}

fn update_ms(record: &FrameRecord) -> f64 {
    record.update_ms
}

fn render_ms(record: &FrameRecord) -> f64 {
    record.trace_ms + record.shade_ms
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordu32, RangedCoordf64>>;

fn draw(stats: &Stats) -> Result<String> {
    let frames = &stats.frames;
    let frame_at = |record: Option<&FrameRecord>| record.map_or(0, |record| record.frame);
    let (first, last) = (frame_at(frames.first()), frame_at(frames.last()));
    let slowest = frames.iter().map(|r| render_ms(r).max(update_ms(r))).fold(0.001, f64::max);

    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title(stats), ("sans-serif", 20))
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(72)
        .build_cartesian_2d(first..last.max(first.saturating_add(1)), 0.0..slowest * 1.15)?;
    draw_axes(&mut chart)?;
    draw_series(&mut chart, frames, "render: trace and shade", RENDER_COLOR, render_ms)?;
    draw_series(&mut chart, frames, "update: geometry of the frame", UPDATE_COLOR, update_ms)?;
    draw_legend(&mut chart)?;
    area.present()?;
    drop(chart);
    drop(area);
    Ok(svg)
}

fn draw_axes(chart: &mut Chart<'_, '_>) -> Result<()> {
    chart
        .configure_mesh()
        .x_desc("frame")
        .y_desc("time per frame (ms)")
        .axis_desc_style(("sans-serif", 15))
        .label_style(("sans-serif", 13))
        .bold_line_style(BLACK.mix(0.1))
        .light_line_style(TRANSPARENT)
        .draw()?;
    Ok(())
}

fn draw_series(
    chart: &mut Chart<'_, '_>,
    frames: &[FrameRecord],
    label: &str,
    color: RGBColor,
    milliseconds: fn(&FrameRecord) -> f64,
) -> Result<()> {
    let points = frames.iter().map(|record| (record.frame, milliseconds(record)));
    // A line through one frame has no length; a dot is seen.
    if frames.len() == 1 {
        chart.draw_series(points.clone().map(|point| Circle::new(point, 4, color.filled())))?;
    }
    chart
        .draw_series(LineSeries::new(points, color.stroke_width(2)))?
        .label(label)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3)));
    Ok(())
}

fn draw_legend<'a, 'b: 'a>(chart: &mut Chart<'a, 'b>) -> Result<()> {
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .legend_area_size(32)
        .label_font(("sans-serif", 14))
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    Ok(())
}

fn title(stats: &Stats) -> String {
    let Stats { input, engine, threads, size, .. } = stats;
    let plural = if *threads == 1 { "" } else { "s" };
    format!("Update and render time: {input}, {engine}, {threads} thread{plural}, {size}")
}

/// The graph and its summary as a page that needs nothing else.
fn page(stats: &Stats, svg: &str) -> String {
    let title = escaped(&title(stats));
    let row = |name: &str, milliseconds: fn(&FrameRecord) -> f64| {
        let mut times: Vec<f64> = stats.frames.iter().map(milliseconds).collect();
        times.sort_by(f64::total_cmp);
        let at = |share: usize| times.get(share * times.len().saturating_sub(1) / 2).copied();
        let [least, median, most] = [0, 1, 2].map(|share| at(share).unwrap_or_default());
        format!("<tr><td>{name}<td>{least:.2}<td>{median:.2}<td>{most:.2}")
    };
    let (update, render) = (row("update", update_ms), row("render", render_ms));
    let (frame_count, triangles) = (stats.frames.len(), stats.triangles);
    let simd = stats.simd;
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>body {{ font-family: sans-serif; margin: 2em auto; max-width: 960px }} \
         svg {{ width: 100%; height: auto }} td, th {{ text-align: right; padding: 0.2em 1em }}\
         </style>\n{svg}\n\
         <p>{frame_count} frames, {triangles} triangles at most, SIMD level {simd}.</p>\n\
         <table><tr><th>time per frame (ms)<th>least<th>median<th>most{update}{render}</table>\n\
         </html>\n"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
