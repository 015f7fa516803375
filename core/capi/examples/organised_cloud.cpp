// Segments an organised point cloud, as a depth camera gives it: points row after row in the camera's optical frame (x right,
// y down, z forward), NaN where nothing was measured. No library of point clouds is needed; the two usual layouts are:
//
//   PCL     pcl::PointCloud<pcl::PointXYZ>: cloud.points[i].data, four floats a point, the last one unused
//   Eigen   Eigen::Matrix3Xf, or a Map of it: three floats a point, one after the other
//
// Both are `Layout` below: a pointer to the first x, and floats from a point to the next.
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <scanseg.hpp>

namespace {

struct Layout {
    const float *first;
    std::size_t stride;
};

struct Camera {
    std::size_t columns = 160, rows = 120;
    float fx = 140, fy = 140, cx = 79.5F, cy = 59.5F;
};

struct Found {
    std::vector<std::uint32_t> labels; // of each point; 0 in no segment
    std::vector<scanseg_event> segments;
};

// One range per point: its distance, not its depth.
std::vector<float> ranges(const Layout &cloud, std::size_t points) {
    std::vector<float> ranges_m(points);
    for (std::size_t i = 0; i < points; i++) {
        const float *point = cloud.first + i * cloud.stride;
        ranges_m[i] = std::sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2]);
    }
    return ranges_m;
}

bool segment(const Layout &cloud, const Camera &camera, std::uint32_t approach, Found &found) {
    scanseg::Config config;
    config.approach = approach;
    config.columns = static_cast<std::uint32_t>(camera.columns);
    config.beams = SCANSEG_PINHOLE;
    config.fx_px = camera.fx;
    config.fy_px = camera.fy;
    config.cx_px = camera.cx;
    config.cy_px = camera.cy;
    config.range_noise_m = 0.002F;

    scanseg::Segmenter segmenter(config);
    if (!segmenter.status()) {
        const char *field = config.bad_field();
        std::printf("%s: %s\n", field != nullptr ? field : "scanseg", segmenter.status().what());
        return false;
    }
    const std::vector<float> ranges_m = ranges(cloud, camera.columns * camera.rows);
    if (!segmenter.segment_image(ranges_m)) return false;
    for (const std::uint32_t label : segmenter.labels()) {
        found.labels.push_back(label < SCANSEG_UNLABELLED ? label : 0);
    }
    found.segments.assign(segmenter.events().begin(), segmenter.events().end());
    return true;
}

// A corner of a room, 3 m ahead: floor, left wall, right wall; and a hole.
std::vector<float> corner(const Camera &camera, std::size_t stride) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> points(camera.columns * camera.rows * stride, nan);
    for (std::size_t v = 0; v < camera.rows; v++) {
        for (std::size_t u = 0; u < camera.columns; u++) {
            const float x = (static_cast<float>(u) - camera.cx) / camera.fx;
            const float y = (static_cast<float>(v) - camera.cy) / camera.fy;
            float z = 3 / (1 + std::fabs(x)); // walls: z + |x| z = 3
            if (y * z > 0.6F) z = 0.6F / y;   // floor: y = 0.6
            if (u > 70 && u < 75 && v > 20 && v < 30) continue;
            float *point = &points[(v * camera.columns + u) * stride];
            point[0] = x * z;
            point[1] = y * z;
            point[2] = z;
        }
    }
    return points;
}

} // namespace

int main() {
    const Camera camera;
    const std::vector<float> pcl = corner(camera, 4), eigen = corner(camera, 3);
    for (std::uint32_t approach = SCANSEG_PLANE; approach <= SCANSEG_REGION; approach++) {
        Found found, again;
        if (!segment({pcl.data(), 4}, camera, approach, found)) return 1;
        if (!segment({eigen.data(), 3}, camera, approach, again) || again.labels != found.labels) return 1;
        int large = 0;
        for (const scanseg_event &segment : found.segments) {
            scanseg_plane plane;
            if (segment.pixels < 1000 || !scanseg::fit_plane(segment, plane)) continue;
            large++;
            // back to the optical frame: x right, y down, z forward
            std::printf("%u: %5u points, normal %6.3f %6.3f %6.3f, distance %.3f m, rms %.4f m\n", segment.label,
                        segment.pixels, static_cast<double>(-plane.normal[1]), static_cast<double>(-plane.normal[2]),
                        static_cast<double>(plane.normal[0]), static_cast<double>(plane.distance_m),
                        static_cast<double>(plane.rms_m));
        }
        if (large != 3) {
            std::printf("%d large segments, expected floor and two walls\n", large);
            return 1;
        }
    }
    return 0;
}
