// SPDX-License-Identifier: GPL-3.0-or-later
// Times a tick on a rigid surface along a recorded path: the sliding and pressing of "Numbers to
// beat". usage: bench_tick SURFACE.vtp PATH.txt
#include <cstdio>
#include <exception>

#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/realtime/histogram.hpp"
#include "runtime/realtime/periodic_clock.hpp"
#include "tools/meshing/mesh_files.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate {
namespace {

void report(const char* what, const Histogram& histogram) {
    const auto us = [&](double fraction) {
        return 1e-3 * static_cast<double>(histogram.percentile(fraction));
    };
    std::printf("%-34s %8.2f %8.2f %8.2f %8.2f\n", what, us(0.5), us(0.99), us(0.999),
                1e-3 * static_cast<double>(histogram.max()));
}

template <typename Work>
std::uint64_t nanoseconds(Work work) {
    const std::int64_t begin = monotonic_ns();
    work();
    return static_cast<std::uint64_t>(monotonic_ns() - begin);
}

std::int64_t ticks_of(const HandPath& path) {
    return static_cast<std::int64_t>(1000 * path.duration()) + 1;
}

void bench_ticks(const Case& patient_case, const HandPath& path, const char* what) {
    HapticModel model(patient_case);
    TickResult result{};
    Histogram histogram;
    std::int64_t touching = 0, inside = 0;
    double peak = 0;
    for (std::int64_t tick = 0; tick < ticks_of(path); ++tick) {
        DeviceState state;
        state.time = 1e-3 * static_cast<double>(tick);
        Eigen::Map<Eigen::Vector3d>(state.position.data()) = path.at(state.time);
        histogram.record(nanoseconds([&] { model.tick(state, result); }));
        touching += result.contact_count > 0;
        const Eigen::Map<const Eigen::Vector3d> tool(result.tool_position.data());
        inside += model.surface(0).closest_point(tool, patient_case.haptics.tool_radius - 1e-6).has_value();
        peak = std::max(peak, Eigen::Map<const Eigen::Vector3d>(result.force.data()).norm());
    }
    report(what, histogram);
    std::printf("    %lld ticks, %lld touching, %lld with the tool below the surface, peak %.2f N\n",
                static_cast<long long>(ticks_of(path)), static_cast<long long>(touching),
                static_cast<long long>(inside), peak);
}

void bench_queries(const CollisionSurface& surface, const HandPath& path) {
    Histogram closest, segment;
    std::int32_t hint = -1;
    Eigen::Vector3d last = path.at(0);
    for (std::int64_t tick = 0; tick < ticks_of(path); ++tick) {
        const Eigen::Vector3d p = path.at(1e-3 * static_cast<double>(tick));
        closest.record(nanoseconds([&] {
            if (const auto found = surface.closest_point(p, 1000, hint)) hint = found->slot;
        }));
        segment.record(nanoseconds([&] { surface.sweep_sphere(last, p, 0); }));
        last = p;
    }
    report("closest point", closest);
    report("segment", segment);
}

void bench(const char* surface_file, const char* path_file) {
    Case patient_case;
    patient_case.name = "bench";
    RigidBody& body = patient_case.rigid_bodies.emplace_back();
    body.name = "surface";
    body.surface = read_surface(surface_file);
    body.obb_tree = build_obb_tree(body.surface);
    patient_case.haptics = {
        .tool_radius = 1, .coupling_stiffness = 0.5, .max_force = 3.3, .max_force_rate = 3.3};
    const HandPath path = read_hand_path(path_file);
    const std::int64_t begin = monotonic_ns();
    const CollisionSurface surface(body.surface, body.obb_tree, body.name);
    std::printf("%d triangles, %zu boxes, ready in %.1f ms\n", surface.triangle_count(),
                body.obb_tree.nodes.size(), 1e-6 * static_cast<double>(monotonic_ns() - begin));
    std::printf("%-34s %8s %8s %8s %8s\n", "us", "p50", "p99", "p99.9", "max");
    bench_queries(surface, path);
    bench_ticks(patient_case, path, "tick, 1 mm sphere");
    patient_case.haptics.tool_radius = 0.01;
    bench_ticks(patient_case, path, "tick, point (0.01 mm)");
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "usage: bench_tick SURFACE.vtp PATH.txt\n");
        return 2;
    }
    palpate::bench(argv[1], argv[2]);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_tick: %s\n", error.what());
    return 1;
}
