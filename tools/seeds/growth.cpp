// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/growth.hpp"

#include <utility>

namespace palpate::seeds {
namespace {

using namespace imaging;

Growth grow(const Volume& volume, const std::vector<Seed>& seeds) {
    Growth growth;
    if (seeds.empty()) return growth;
    growth.map = grow_from_seeds(volume, seeds, preview_parameters(volume.grid));
    std::vector<std::size_t> voxels(growth.map.names.size() + 1, 0);  // labels count up from 1
    for (const std::uint16_t label : growth.map.labels) ++voxels[label];
    for (const Label& label : growth.map.names)
        growth.volume_ml.push_back(static_cast<double>(voxels[label.value]) * volume.grid.voxel_volume() /
                                   1000);
    return growth;
}

}  // namespace

GrowthWorker::GrowthWorker(const Volume& volume) : volume_(volume), thread_([this] { work(); }) {}

GrowthWorker::~GrowthWorker() {
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void GrowthWorker::request(std::vector<Seed> seeds) {
    {
        const std::lock_guard lock(mutex_);
        waiting_ = Request{std::move(seeds), std::chrono::steady_clock::now()};
    }
    changed_.notify_all();
}

bool GrowthWorker::busy() const {
    const std::lock_guard lock(mutex_);
    return waiting_ || growing_ || grown_ || failed_;
}

std::shared_ptr<const Growth> GrowthWorker::take() {
    const std::lock_guard lock(mutex_);
    if (failed_) std::rethrow_exception(std::exchange(failed_, nullptr));
    return std::exchange(grown_, nullptr);
}

void GrowthWorker::wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !waiting_ && !growing_; });
}

void GrowthWorker::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return waiting_ || ended_; });
        if (ended_) return;
        const Request request = *std::exchange(waiting_, std::nullopt);
        growing_ = true;
        lock.unlock();
        std::shared_ptr<Growth> growth;
        std::exception_ptr failed;
        try {
            growth = std::make_shared<Growth>(grow(volume_, request.seeds));
            growth->seconds =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - request.asked).count();
        } catch (...) {
            failed = std::current_exception();
        }
        lock.lock();
        growing_ = false;
        grown_ = growth;
        if (failed) failed_ = failed;
        changed_.notify_all();
    }
}

}  // namespace palpate::seeds
