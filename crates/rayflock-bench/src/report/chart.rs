//! Charts as inline SVG in the colours of the page.
//!
//! Charts are drawn in colours that stand for others: they are replaced by the properties of the
//! style sheet, so that one drawing is read in both themes. Text stays text, in the page's fonts.

use maud::{Markup, PreEscaped, html};
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use crate::BenchError;

/// Colours that stand for the ink and the grid of the page.
const INK: RGBColor = RGBColor(1, 2, 3);
const GRID: RGBColor = RGBColor(1, 2, 4);
/// Red and green of the colours that stand for those of series; blue counts them.
const SERIES: (u8, u8) = (1, 3);
/// Colours of series in the style sheet.
const SERIES_COUNT: usize = 6;

/// Width and height of most charts, in pixels.
pub(super) const SIZE: (u32, u32) = (640, 340);

/// A curve.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// Its name in the legend.
    pub(super) label: String,
    /// Which colour.
    pub(super) color_idx: usize,
    /// Whether the line is broken.
    pub(super) dashed: bool,
    /// Its points, from left to right.
    pub(super) points: Vec<(f64, f64)>,
}

/// How the axes are divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    /// Evenly, upward from 0.
    Linear,
    /// By powers of 2 across and of 10 upward.
    Logarithmic,
}

/// A chart to be drawn.
#[derive(Clone, Debug)]
pub(super) struct Chart<'a> {
    /// What it shows, for those who cannot see it.
    pub(super) title: &'a str,
    /// What is across.
    pub(super) x_label: &'a str,
    /// What is upward.
    pub(super) y_label: &'a str,
    /// How numbers across are written.
    pub(super) x_text: fn(f64) -> String,
    /// How the axes are divided.
    pub(super) scale: Scale,
    /// The curves.
    pub(super) series: Vec<Series>,
    /// Width and height in pixels.
    pub(super) size: (u32, u32),
}

impl Chart<'_> {
    /// The chart and its legend.
    ///
    /// # Errors
    /// [`BenchError::Draw`].
    pub(super) fn draw(&self) -> Result<Markup, BenchError> {
        let mut svg = String::new();
        let drawn = match (self.scale, self.range(|point| point.0), self.range(|point| point.1)) {
            (Scale::Linear, x, y) => {
                let x = x[0]..x[1].max(x[0] + 1.0);
                self.draw_on(&mut svg, x, 0.0..1.08 * y[1].max(0.001))
            }
            (Scale::Logarithmic, x, y) => {
                let x = (x[0]..x[1].max(2.0 * x[0])).log_scale().base(2.0);
                let decade = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.log10()));
                let (least, most) = (decade(y[0], f64::floor), decade(y[1], f64::ceil));
                let y = (least..most.max(10.0 * least)).log_scale().base(10.0);
                self.draw_on(&mut svg, x, y)
            }
        };
        drawn.map_err(|error| BenchError::Draw(error.to_string()))?;
        Ok(html! {
            figure.chart {
                figcaption { (self.title) }
                div.scroll { (PreEscaped(self.themed(&svg))) }
                (self.legend())
            }
        })
    }

    /// The least and the greatest value of all points; 0 and 1 where there are none.
    fn range(&self, value: fn(&(f64, f64)) -> f64) -> [f64; 2] {
        let points = self.series.iter().flat_map(|series| &series.points);
        let range = points.map(value).map(|value| [value, value]);
        range.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or([0.0, 1.0])
    }

    fn draw_on<X, Y>(&self, svg: &mut String, x: X, y: Y) -> Result<(), Box<dyn std::error::Error>>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let area = SVGBackend::with_string(svg, self.size).into_drawing_area();
        let mut chart = ChartBuilder::on(&area)
            .margin(8)
            .margin_right(20)
            .x_label_area_size(44)
            .y_label_area_size(62)
            .build_cartesian_2d(x, y)?;
        let x_text = self.x_text;
        chart
            .configure_mesh()
            .x_desc(self.x_label)
            .y_desc(self.y_label)
            .axis_desc_style(("sans-serif", 15).into_font().color(&INK))
            .label_style(("sans-serif", 14).into_font().color(&INK))
            .axis_style(INK.mix(0.6))
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&|value| x_text(*value))
            .y_label_formatter(&|value| self.y_text(*value))
            .draw()?;
        for series in &self.series {
            let color = color(series.color_idx);
            let points = series.points.iter().copied();
            if series.dashed {
                chart.draw_series(DashedLineSeries::new(points, 5, 4, color.stroke_width(2)))?;
            } else {
                chart.draw_series(LineSeries::new(points, color.stroke_width(2)))?;
            }
            // Through few points a line alone does not tell where they are.
            let dots = series.points.iter().copied().filter(|_| series.points.len() <= 60);
            chart.draw_series(dots.map(|point| Circle::new(point, 3, color.filled())))?;
        }
        area.present()?;
        Ok(())
    }

    /// A number on the axis upward, without digits that say nothing. Powers of ten are enough
    /// where the axis is logarithmic.
    fn y_text(&self, value: f64) -> String {
        let logarithm = value.log10();
        let is_power = (logarithm - logarithm.round()).abs() < 1e-6;
        if self.scale == Scale::Logarithmic && !is_power {
            return String::new();
        }
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }

    /// The drawing in the colours of the page, as wide as it may be.
    fn themed(&self, svg: &str) -> String {
        let inside = svg.split_once('>').map_or(svg, |(_, inside)| inside);
        let mut inside =
            inside.replace("#010203", "currentColor").replace("#010204", "var(--grid)");
        for idx in 0..SERIES_COUNT {
            let stand_in = format!("#{:02x}{:02x}{idx:02x}", SERIES.0, SERIES.1).to_uppercase();
            inside = inside.replace(&stand_in, &format!("var(--series-{idx})"));
        }
        let (width, height) = self.size;
        let title = html! { (self.title) }.into_string();
        format!(
            "<svg role=\"img\" aria-label=\"{title}\" viewBox=\"0 0 {width} {height}\">{inside}"
        )
    }

    fn legend(&self) -> Markup {
        html! {
            ul.series {
                @for series in &self.series {
                    li {
                        span.line.dashed[series.dashed]
                            style={ "color:var(--series-" (series.color_idx % SERIES_COUNT) ")" } { }
                        (series.label)
                    }
                }
            }
        }
    }
}

fn color(idx: usize) -> RGBColor {
    RGBColor(SERIES.0, SERIES.1, (idx % SERIES_COUNT) as u8)
}
