//! The intrinsics of depth cameras, as others write them: TUM and ORB-SLAM (YAML), ROS
//! `camera_info` (YAML), RealSense and Open3D (JSON).

use crate::geometry::{Depth, Kind};
use crate::scan::CameraOptions;
use crate::scan_error::ScanError;

/// What is known of a camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Camera {
    /// fx, fy, cx, cy; pixels.
    numbers: [Option<f64>; 4],
    /// Rows and columns of its images.
    size: (Option<f64>, Option<f64>),
    /// Metres of a count.
    pub unit_m: Option<f64>,
    /// Whether its lens bends straight lines.
    pub bends: bool,
}

/// Whether a text is YAML or JSON rather than TOML: a first key that ends with a colon.
pub(crate) fn is_camera(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| {
        line.starts_with(['{', '%']) || line == "---" || line.find(':').is_some_and(|at| !line[..at].contains('='))
    })
}

impl Camera {
    /// Finds the numbers of a camera in a text, whatever lies around them.
    pub fn parse(text: &str) -> Camera {
        let mut camera = Camera::default();
        for (parent, key, values) in entries(text) {
            let name = key.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
            let first = values[0];
            match (name.as_str(), &values[..]) {
                ("fx", _) => _ = camera.numbers[0].get_or_insert(first),
                ("fy", _) => _ = camera.numbers[1].get_or_insert(first),
                ("cx" | "ppx", _) => _ = camera.numbers[2].get_or_insert(first),
                ("cy" | "ppy", _) => _ = camera.numbers[3].get_or_insert(first),
                // by columns
                ("intrinsic_matrix", [fx, _, _, _, fy, _, cx, cy, _]) => camera.set([*fx, *fy, *cx, *cy]),
                ("k" | "data", [fx, _, cx, _, fy, cy, _, _, _]) if name == "k" || parent == "camera_matrix" => {
                    camera.set([*fx, *fy, *cx, *cy]);
                }
                ("width" | "image_width", _) => _ = camera.size.1.get_or_insert(first),
                ("height" | "image_height", _) => _ = camera.size.0.get_or_insert(first),
                ("depthmapfactor", _) => _ = camera.unit_m.get_or_insert(1.0 / first),
                ("depth_scale" | "depth_units", _) => _ = camera.unit_m.get_or_insert(first),
                ("d" | "coeffs" | "k1" | "k2" | "k3" | "p1" | "p2", _) => {
                    camera.bends |= values.iter().any(|x| *x != 0.0)
                }
                ("data", _) if parent.starts_with("distortion") => camera.bends |= values.iter().any(|x| *x != 0.0),
                _ => {}
            }
        }
        camera
    }

    fn set(&mut self, numbers: [f64; 4]) {
        (0..4).for_each(|i| _ = self.numbers[i].get_or_insert(numbers[i]));
    }

    /// The same with the numbers that are given. Returns whether any is.
    pub fn overrule(&mut self, options: &CameraOptions) -> bool {
        let given = [options.fx_px, options.fy_px, options.cx_px, options.cy_px];
        (0..4).for_each(|i| self.numbers[i] = given[i].or(self.numbers[i]));
        given.iter().any(Option::is_some)
    }

    /// Returns the geometry of its images, if the camera fits them. Pixels are square unless it is
    /// said, and the axis is in the middle.
    pub fn kind(&self, rows: usize, columns: usize) -> Result<Kind, ScanError> {
        let size = (self.size.0.unwrap_or(rows as f64), self.size.1.unwrap_or(columns as f64));
        if size != (rows as f64, columns as f64) {
            let what = format!("{} x {} pixels (the image has {columns} x {rows})", size.1, size.0);
            return Err(ScanError::lacks("a camera", what));
        }
        let [fx, fy, cx, cy] = self.numbers;
        let fx_px = fx.or(fy).ok_or(ScanError::NoGeometry)?;
        let middle = |pixels: usize| (pixels as f64 - 1.0) / 2.0;
        let (cx_px, cy_px) = (cx.unwrap_or(middle(columns)), cy.unwrap_or(middle(rows)));
        Ok(Kind::Pinhole { fx_px, fy_px: fy.unwrap_or(fx_px), cx_px, cy_px, depth: Depth::Z })
    }
}

/// Returns every key that is followed by numbers, with them and with the last key before it that is
/// not.
fn entries(text: &str) -> Vec<(String, String, Vec<f64>)> {
    let mut entries: Vec<(String, String, Vec<f64>)> = vec![];
    let (mut parent, mut key) = (String::new(), String::new());
    let without_comments = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    let lines: Vec<&str> = without_comments.collect();
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+' | '/');
    for line in lines {
        let mut rest = line;
        while let Some(start) = rest.find(plain) {
            let word = &rest[start..];
            let end = word.find(|c| !plain(c)).unwrap_or(word.len());
            let (word, after) = word.split_at(end);
            rest = after;
            if after.trim_start_matches(['"', '\'']).trim_start().starts_with(':') {
                if entries.last().is_none_or(|entry| entry.1 != key) {
                    parent.clone_from(&key);
                }
                word.clone_into(&mut key);
            } else if let Ok(number) = word.parse::<f64>()
                && number.is_finite()
            {
                match entries.last_mut() {
                    Some(entry) if entry.1 == key && entry.0 == parent => entry.2.push(number),
                    _ => entries.push((parent.clone(), key.clone(), vec![number])),
                }
            }
        }
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &str) -> [f64; 4] {
        assert!(is_camera(text), "{text}");
        let camera = Camera::parse(text);
        camera.numbers.map(Option::unwrap)
    }

    #[test]
    fn files_of_others() {
        let orb_slam = "%YAML:1.0\n# freiburg\nCamera.type: \"PinHole\"\nCamera.fx: 535.4\nCamera.fy: 539.2\n\
            Camera.cx: 320.1\nCamera.cy: 247.6\nCamera.k1: 0.0\nCamera.width: 640\nCamera.height: 480\n\
            DepthMapFactor: 5000.0\n";
        assert_eq!(kind(orb_slam), [535.4, 539.2, 320.1, 247.6]);
        let camera = Camera::parse(orb_slam);
        assert_eq!((camera.unit_m, camera.bends, camera.size), (Some(0.0002), false, (Some(480.0), Some(640.0))));
        let ros = "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
            data: [525.5, 0, 319.5, 0, 526.5, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\n\
            distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, -0.2, 0, 0, 0]\nrectification_matrix:\n  \
            rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  \
            data: [1, 0, 2, 0, 0, 3, 4, 0, 0, 0, 1, 0]\n";
        assert_eq!(kind(ros), [525.5, 526.5, 319.5, 239.5]);
        assert!(Camera::parse(ros).bends);
        let echoed = "header:\n  stamp:\n    sec: 17\nheight: 480\nwidth: 640\nd:\n- 0.0\n- 0.0\nk:\n- 525.5\n- 0.0\n\
            - 319.5\n- 0.0\n- 526.5\n- 239.5\n- 0.0\n- 0.0\n- 1.0\nr:\n- 1.0\n";
        assert_eq!(kind(echoed), [525.5, 526.5, 319.5, 239.5]);
        let realsense = r#"{"coeffs": [0.0, 0.0], "fx": 383.1, "fy": 383.2, "height": 480, "model": "Brown", "ppx": 318.3, "ppy": 241.5, "width": 640}"#;
        assert_eq!(kind(realsense), [383.1, 383.2, 318.3, 241.5]);
        let open3d = "{\n \"height\": 480,\n \"intrinsic_matrix\": [\n 525.5,\n 0.0, 0.0, 0.0, 526.5, 0.0, 319.5, 239.5, 1.0 ],\n \"width\": 640 }";
        assert_eq!(kind(open3d), [525.5, 526.5, 319.5, 239.5]);
    }

    #[test]
    fn a_geometry_file_is_none() {
        assert!(!is_camera("# a: b\nversion = 1\nunit_m = 0.001\n"));
    }

    #[test]
    fn a_camera_for_other_images_is_refused() {
        let camera = Camera::parse("{\"width\": 640, \"height\": 480, \"fx\": 500}");
        let Ok(Kind::Pinhole { fy_px, cx_px, cy_px, .. }) = camera.kind(480, 640) else { panic!() };
        assert_eq!((fy_px, cx_px, cy_px), (500.0, 319.5, 239.5));
        assert!(camera.kind(240, 320).is_err());
        assert_eq!(Camera::parse("{}").kind(2, 2), Err(ScanError::NoGeometry));
    }
}
