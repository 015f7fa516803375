//! Clouds, arrays and depth images of others as scans: what is read, what is refused and how it is
//! said.

use std::fs;

use crate::clouds::{POINTS, ascii_pcd, binary_pcd, file, open, open_with, packed_pcd, pcd_of, refused};
use scanseg_formats::{Angles, CameraOptions, Depth, Geometry, Kind, ReadOptions, TurnAxis};

fn even(start_deg: f64, step_deg: f64) -> Angles {
    Angles::Even { start_deg, step_deg }
}

/// Every third pixel or so is missing, and a row and a column as a whole.
fn is_seen(row: usize, column: usize) -> bool {
    row != 7 && column != 11 && !(row * 31 + column * 17 + row * column).is_multiple_of(3)
}

/// Checks that the geometry is found in the points that it makes, and tells where missing pixels look.
fn is_recognised(geometry: &Geometry, rows: usize, columns: usize) {
    let scan = open("recognised.pcd", &pcd_of(geometry, rows, columns, is_seen));
    let found = &scan.geometry;
    assert_eq!(std::mem::discriminant(&found.kind), std::mem::discriminant(&geometry.kind), "{found:?}");
    assert_eq!((scan.image.rows, scan.image.columns), (rows, columns));
    for row in 0..rows {
        for column in 0..columns {
            let apart = |tolerance: f64| {
                let (a, b) = (found.direction(row, column), geometry.direction(row, column));
                let most = (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
                assert!(most < tolerance, "row {row}, column {column}: {a:?} {b:?} {geometry:?}");
            };
            let range_m = scan.image.range_m[row * columns + column];
            assert_eq!(range_m > 0.0, is_seen(row, column));
            if row == 7 && geometry.beside.row_offset_deg.is_some() {
                continue; // nothing tells where its laser looks
            }
            apart(if is_seen(row, column) { 2e-5 } else { 2e-4 });
        }
    }
}

#[test]
fn geometry_is_recognised_in_points_with_gaps() {
    let nodding = |turn_axis| Kind::Nodding { beam_deg: even(-60.0, 2.0), turn_deg: even(-40.0, 1.5), turn_axis };
    is_recognised(&Geometry::of(nodding(TurnAxis::Y)), 40, 60);
    is_recognised(&Geometry::of(nodding(TurnAxis::Z)), 40, 60);
    let elevation_deg = Angles::Listed((0..40).map(|i| 15.0 - 0.7 * f64::from(i) - 0.01 * f64::from(i * i)).collect());
    let spinning = Kind::Spinning { azimuth_deg: even(180.0, -3.0), elevation_deg, wraps: true };
    let mut geometry = Geometry::of(spinning);
    is_recognised(&geometry, 40, 120);
    // lasers that look aside, by up to two columns
    geometry.beside.row_offset_deg = Some(Angles::Listed((0..40).map(|i| [-4.2, -1.4, 1.4, 4.2][i % 4]).collect()));
    is_recognised(&geometry, 40, 120);
    let (fx_px, fy_px, cx_px, cy_px) = (50.0, 55.0, 28.5, 20.25);
    is_recognised(&Geometry::of(Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, depth: Depth::Range }), 40, 60);
}

#[test]
fn a_full_turn_is_told_from_a_part_of_one() {
    for (columns, round) in [(120, true), (110, false)] {
        let (azimuth_deg, elevation_deg) = (even(0.0, 3.0), even(10.0, -1.0));
        let kind = Kind::Spinning { azimuth_deg, elevation_deg, wraps: round };
        let scan = open("turn.pcd", &pcd_of(&Geometry::of(kind), 20, columns, |_, _| true));
        assert!(matches!(scan.geometry.kind, Kind::Spinning { wraps, .. } if wraps == round), "{columns}");
    }
}

#[test]
fn beams_that_are_no_grid_stay_as_they_are() {
    let (rows, columns) = (20, 120);
    let shaken = |row: usize, column: usize| 0.6 * (((row * 7919 + column * 104_729) % 97) as f64 / 97.0 - 0.5);
    let point = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        let azimuth = (3.0 * (column as f64 + shaken(row, column))).to_radians();
        let elevation = (10.0 - row as f64 - shaken(column, row)).to_radians();
        let range = 2.0 + 0.01 * row as f64;
        let flat = range * elevation.cos();
        [flat * azimuth.cos(), flat * azimuth.sin(), range * elevation.sin()].map(|x| x as f32)
    };
    let points: Vec<[f32; 3]> = (0..rows * columns).map(point).collect();
    let scan = open("free.pcd", &binary_pcd(rows, columns, &points));
    let Kind::Free { wraps: true, .. } = scan.geometry.kind else { panic!("{:?}", scan.geometry.kind) };
    for (i, point) in points.iter().enumerate() {
        let direction = scan.geometry.direction(i / columns, i % columns);
        for axis in 0..3 {
            let found = direction[axis] * f64::from(scan.image.range_m[i]);
            assert!((found - f64::from(point[axis])).abs() < 1e-6, "{i}");
        }
    }
}

#[test]
fn clouds_in_the_axes_of_a_camera_are_turned() {
    let kind = Kind::Pinhole { fx_px: 50.0, fy_px: 50.0, cx_px: 29.5, cy_px: 19.5, depth: Depth::Range };
    let points = crate::clouds::points_of(&Geometry::of(kind.clone()), 40, 60, |_, _| true);
    let straight = open("forward.pcd", &binary_pcd(40, 60, &points));
    assert_eq!(straight.remarks, [""; 0]);
    let optical: Vec<_> = points.iter().map(|[x, y, z]| [-y, -z, *x]).collect();
    let graphics: Vec<_> = points.iter().map(|[x, y, z]| [-y, *z, -x]).collect();
    for (points, axes) in [(optical, "x right, y down, z forward"), (graphics, "x right, y up, z backward")] {
        let scan = open("camera.pcd", &binary_pcd(40, 60, &points));
        assert!(scan.remarks[0].contains(axes), "{:?}", scan.remarks);
        assert_eq!(scan.geometry, straight.geometry);
        assert_eq!(scan.image, straight.image);
    }
}

/// Whether a file ends with text.
fn texts_end(name: &str) -> bool {
    ["ascii", "windows", "grid"].iter().any(|kind| name.starts_with(kind))
}

#[test]
fn every_kind_of_pcd_and_ply_has_the_same_points() {
    let expected = open("binary.pcd", &binary_pcd(3, 4, &POINTS));
    assert_eq!(expected.measured, 10);
    let texts = POINTS.map(|[x, y, z]| format!("{x} {y} {z}"));
    let ply = |kind: &str, body: &[u8]| {
        let header =
            format!("ply\nformat {kind} 1.0\ncomment made by hand\nobj_info num_cols 4\nobj_info num_rows 3\n");
        let elements = "element vertex 12\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        [header.as_bytes(), elements.as_bytes(), body].concat()
    };
    let bytes = |of: fn(f32) -> [u8; 4]| POINTS.iter().flatten().flat_map(|x| of(*x)).collect::<Vec<u8>>();
    let mut grid = b"ply\nformat ascii 1.0\nobj_info num_cols 4\nobj_info num_rows 3\nelement vertex 10\n\
        property double x\nproperty double y\nproperty double z\nproperty uchar red\nelement range_grid 12\n\
        property list uchar int vertex_indices\nend_header\n"
        .to_vec();
    let seen = || (0..12).filter(|&i: &usize| POINTS[i][0].is_finite() && POINTS[i] != [0.0; 3]);
    seen().for_each(|i| grid.extend(format!("{} 7\n", texts[i]).bytes()));
    for i in 0..12 {
        let line = seen().position(|seen| seen == i).map_or("0\n".to_string(), |vertex| format!("1 {vertex}\n"));
        grid.extend(line.bytes());
    }
    let files = [
        ("ascii.pcd", ascii_pcd(3, 4, &texts)),
        ("windows.pcd", String::from_utf8(ascii_pcd(3, 4, &texts)).unwrap().replace('\n', "\r\n").into_bytes()),
        ("packed.pcd", packed_pcd(3, 4, &POINTS)),
        ("ascii.ply", ply("ascii", texts.join("\n").as_bytes())),
        ("little.ply", ply("binary_little_endian", &bytes(f32::to_le_bytes))),
        ("big.ply", ply("binary_big_endian", &bytes(f32::to_be_bytes))),
        ("grid.ply", grid),
    ];
    for (name, bytes) in files {
        let scan = open(name, &bytes);
        assert_eq!((&scan.image, scan.measured), (&expected.image, 10), "{name}");
        // nothing but whole files, but for the digits of the last line
        let last = if texts_end(name) { 20 } else { 1 };
        for length in 0..=bytes.len() - last {
            let message = refused(name, &bytes[..length]);
            assert!(message.lines().count() == 1 && message.len() < 500, "{message}");
        }
    }
}

#[test]
fn a_pcd_may_have_its_fields_in_any_order_and_of_any_type() {
    let text = "FIELDS z normals x y\nSIZE 8 4 2 4\nTYPE F F I F\nCOUNT 1 3 1 1\nWIDTH 2\nHEIGHT 2\n\
        VIEWPOINT 1 2 3 1 0 0 0\nPOINTS 4\nDATA binary\n";
    let mut bytes = text.as_bytes().to_vec();
    for i in 0..4i16 {
        bytes.extend(3f64.to_le_bytes());
        bytes.extend([0; 12]);
        bytes.extend((i + 3).to_le_bytes());
        bytes.extend(2f32.to_le_bytes());
    }
    // from where the scanner stood
    assert_eq!(open("fields.pcd", &bytes).image.range_m, [2.0, 3.0, 4.0, 5.0]);
}

#[test]
fn what_is_no_organised_cloud_is_refused_and_says_what_to_do() {
    let texts = POINTS.map(|[x, y, z]| format!("{x} {y} {z}"));
    let list = String::from_utf8(ascii_pcd(1, 12, &texts)).unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
    let cases = [
        ("list.pcd", list.as_str(), "12 points without rows and columns: its HEIGHT is 1."),
        ("list.ply", ply, "1 points without rows and columns: its header has no num_cols and num_rows."),
        ("none.txt", "1 2 3\n4 5 6\n", "none of the formats that are read"),
        (
            "none.pcd",
            "VERSION .7\nFIELDS a b\nSIZE 4 4\nTYPE F F\nWIDTH 2\nHEIGHT 2\nDATA ascii\n",
            "fields x, y and z",
        ),
        (
            "data.pcd",
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nDATA zip\n",
            "DATA zip is not",
        ),
        (
            "size.pcd",
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nDATA ascii\n",
            "TYPE and SIZE",
        ),
        ("none.ply", "ply\nformat ascii 1.0\nend_header\n", "0 points without rows and columns"),
    ];
    for (name, text, says) in cases {
        let message = refused(name, text.as_bytes());
        assert!(message.contains(says), "{message}");
    }
    let nothing = refused("nothing.pcd", &binary_pcd(2, 2, &[[f32::NAN; 3]; 4]));
    assert!(nothing.contains("none of 4 pixels has a distance"), "{nothing}");
    let huge = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 99999\nHEIGHT 99999\nDATA binary\n";
    let message = refused("huge.pcd", huge.as_bytes());
    assert!(message.contains("9999800001 pixels, not 1 to 16777216"), "{message}");
}

/// An array of NumPy.
fn npy(kind: &str, shape: &str, order: &str, data: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}");
    header += &" ".repeat(63 - (header.len() + 10) % 64);
    header.push('\n');
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

#[test]
fn arrays_of_numpy() {
    let camera = CameraOptions { fx_px: Some(10.0), cx_px: Some(1.0), cy_px: Some(0.0), ..CameraOptions::default() };
    let options = ReadOptions { camera, ..ReadOptions::default() };
    let counts: Vec<u8> = [2000u16, 1000, 0, 3000].iter().flat_map(|x| x.to_le_bytes()).collect();
    let metres: Vec<u8> = [2f32, 1.0, f32::NAN, 3.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let expected = [2.0 * 1.01f32.sqrt(), 1.0, 0.0, 3.0 * 1.01f32.sqrt()];
    for bytes in [npy("<u2", "(2, 2)", "False", &counts), npy("<f4", "(2, 2, 1)", "False", &metres)] {
        let scan = open_with("depth.npy", &bytes, &options).unwrap();
        for (found, expected) in scan.image.range_m.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6 || *found == expected, "{found} {expected}");
        }
        let far = ReadOptions { unit_m: Some(0.5), ..options.clone() };
        assert_eq!(open_with("depth.npy", &bytes, &far).unwrap().geometry.unit_m, 0.5);
    }
    let points: Vec<u8> = POINTS.iter().flatten().flat_map(|x| f64::from(*x).to_le_bytes()).collect();
    let scan = open("points.npy", &npy("<f8", "(3, 4, 3)", "False", &points));
    assert_eq!(scan.image, open("binary.pcd", &binary_pcd(3, 4, &POINTS)).image);
    let cases = [
        (npy("<f8", "(3, 4, 3)", "True", &points), "save numpy.ascontiguousarray(a)"),
        (npy(">f8", "(3, 4, 3)", "False", &points), "little-endian"),
        (npy("<f8", "(12, 3)", "False", &points), "12 points without rows and columns"),
        (npy("<f8", "(36,)", "False", &points), "rows x columns x 3"),
        (npy("<f8", "(3, 4, 3)", "False", &points[1..]), "288 bytes, the file has 287"),
        (npy("<c8", "(3, 4, 3)", "False", &points), "it has <c8"),
        (b"\x93NUMPY\x01\x00".to_vec(), "no header"),
        (npy("<f4", "(2, 2)", "False", &metres), "give --geometry FILE, or --fx PIXELS"),
    ];
    for (bytes, says) in cases {
        let message = refused("bad.npy", &bytes);
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn a_camera_file_gives_depths_their_beams() {
    let png = scanseg_formats::GreyImage { rows: 2, columns: 2, max_value: 65535, values: vec![5000, 0, 10_000, 5000] };
    let intrinsics = file(
        "tum.yaml",
        b"%YAML:1.0\nCamera.fx: 10.0\nCamera.fy: 10.0\nCamera.cx: 0.0\nCamera.cy: 0.0\n\
        Camera.k1: 0.2\nDepthMapFactor: 5000.0\n",
    );
    let options = ReadOptions { geometry: Some(intrinsics), ..ReadOptions::default() };
    let scan = open_with("depth.png", &png.to_png(), &options).unwrap();
    assert_eq!(scan.image.range_m[..2], [1.0, 0.0]);
    assert!(scan.remarks[0].contains("distortion"), "{:?}", scan.remarks);
    let wrong =
        file("realsense.json", b"{\"fx\": 10, \"fy\": 10, \"ppx\": 1, \"ppy\": 1, \"width\": 640, \"height\": 480}");
    let options = ReadOptions { geometry: Some(wrong), ..ReadOptions::default() };
    let message = open_with("depth.png", &png.to_png(), &options).unwrap_err();
    assert!(message.contains("640 x 480 pixels (the image has 2 x 2)"), "{message}");
    let geometry = file(
        "geometry.toml",
        b"version = 1\nunit_m = 0.001\nkind = \"pinhole\"\ndepth = \"z\"\nfx = 10\nfy = 10\ncx = 0\ncy = 0\n",
    );
    let camera = CameraOptions { fx_px: Some(10.0), ..CameraOptions::default() };
    let options = ReadOptions { geometry: Some(geometry), camera, ..ReadOptions::default() };
    let message = open_with("depth.png", &png.to_png(), &options).unwrap_err();
    assert!(message.contains("--fx and the like are for images without it"), "{message}");
}

/// An E57 file of the points, with the indices of rows and columns or without.
fn e57_of(rows: usize, columns: usize, points: &[[f32; 3]], indexed: bool) -> Vec<u8> {
    use e57::{E57Writer, Record, RecordDataType, RecordName, RecordValue};
    let path = file("made.e57", b"");
    let mut writer = E57Writer::from_file(&path, "{file}").unwrap();
    let mut prototype = vec![Record::CARTESIAN_X_F32, Record::CARTESIAN_Y_F32, Record::CARTESIAN_Z_F32];
    let index =
        |name, count: usize| Record { name, data_type: RecordDataType::Integer { min: 0, max: count as i64 - 1 } };
    if indexed {
        prototype.extend([index(RecordName::RowIndex, rows), index(RecordName::ColumnIndex, columns)]);
    }
    let mut cloud = writer.add_pointcloud("{cloud}", prototype).unwrap();
    for (i, point) in points.iter().enumerate().filter(|(_, point)| point[0].is_finite()) {
        let mut values: Vec<_> = point.iter().map(|x| RecordValue::Single(*x)).collect();
        if indexed {
            values.extend([i / columns, i % columns].map(|index| RecordValue::Integer(index as i64)));
        }
        cloud.add_point(values).unwrap();
    }
    cloud.finalize().unwrap();
    writer.finalize().unwrap();
    drop(writer);
    fs::read(path).unwrap()
}

#[test]
fn an_e57_with_indices_is_read_and_one_without_refused() {
    let bytes = e57_of(3, 4, &POINTS, true);
    assert_eq!(open("indexed.e57", &bytes).image, open("binary.pcd", &binary_pcd(3, 4, &POINTS)).image);
    let message = refused("list.e57", &e57_of(3, 4, &POINTS, false));
    assert!(message.contains("points without rows and columns: it has no rowIndex and columnIndex"), "{message}");
    let mut claims = bytes.clone();
    claims[36] = 1;
    let message = refused("claims.e57", &claims);
    assert!(message.contains("claims more bytes than the file has"), "{message}");
    for length in (0..bytes.len()).step_by(61) {
        assert_eq!(refused("short.e57", &bytes[..length]).lines().count(), 1);
    }
}

/// As from a disk; what names other files, or is read piece by piece, is refused.
#[test]
fn bytes_of_images_and_clouds_need_no_disk() {
    let png = scanseg_formats::GreyImage { rows: 2, columns: 2, max_value: 65535, values: vec![5000, 0, 10_000, 5000] };
    let toml = "version = 1\nunit_m = 0.001\nkind = \"pinhole\"\ndepth = \"range\"\nfx = 10\nfy = 10\ncx = 0\ncy = 0\n";
    let yaml = "Camera.fx: 10.0\nCamera.fy: 10.0\nDepthMapFactor: 1000.0\n";
    let read = |bytes: &[u8], text: Option<&str>| {
        let geometry = text.map(|_| "beside.txt".into());
        let options = ReadOptions { geometry, geometry_text: text.map(Into::into), ..ReadOptions::default() };
        scanseg_formats::ScanFile::of_bytes("dropped", bytes, &options)
            .and_then(|mut file| file.frame(0))
            .map_err(|e| e.to_string())
    };
    for text in [toml, yaml] {
        let scan = read(&png.to_png(), Some(text)).unwrap();
        assert_eq!((scan.name.as_str(), scan.image.range_m[0] > 4.99, scan.measured), ("dropped", true, 3));
    }
    let said = read(&png.to_png(), Some("version = 2\n")).unwrap_err();
    assert!(said.starts_with("beside.txt: "), "{said}");
    let cloud =
        b"ply\nformat ascii 1.0\nobj_info num_cols 2\nobj_info num_rows 1\nelement vertex 2\nproperty float x\n\
        property float y\nproperty float z\nend_header\n2 0 0\n2 1 0\n";
    assert_eq!(read(cloud, None).map(|scan| scan.measured), Ok(2));
    // the limits of a geometry that is not on a disk hold for clouds too
    let near = read(cloud, Some(&format!("max_range_m = 2.1\n{toml}"))).unwrap();
    assert_eq!(near.image.range_m, [2.0, 0.0]);
    let mcap = b"\x89MCAP0\r\n";
    assert_eq!(read(mcap, None).unwrap_err(), "dropped: a capture or a recording without its file on a disk");
}
