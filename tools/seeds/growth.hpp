// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "tools/imaging/voxels/grow_from_seeds.hpp"

namespace palpate::seeds {

/// What grew from some seeds.
struct Growth {
    LabelMap map;                   ///< empty without seeds
    std::vector<double> volume_ml;  ///< of each of map.names
    double seconds = 0;             ///< from asking to having
};

/// Grows labels beside the window, by grow_from_seeds() with preview_parameters(). One growth at a time; of
/// requests made meanwhile the last one counts.
class GrowthWorker {
  public:
    /// Keeps a reference to `volume`.
    explicit GrowthWorker(const Volume& volume);
    GrowthWorker(const GrowthWorker&) = delete;
    GrowthWorker& operator=(const GrowthWorker&) = delete;
    /// Waits for the growth under way, drops the one waiting.
    ~GrowthWorker();

    /// Asks for a growth; returns at once.
    void request(std::vector<imaging::Seed> seeds);
    /// Tells whether something asked for has not been taken yet.
    bool busy() const;
    /// The latest growth since the last call, nothing if there is none; throws what growing threw, such as
    /// InvalidInput for a seed outside the volume.
    std::shared_ptr<const Growth> take();
    /// Waits until everything asked for has grown.
    void wait();

  private:
    struct Request {
        std::vector<imaging::Seed> seeds;
        std::chrono::steady_clock::time_point asked;
    };
    void work();

    const Volume& volume_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Request> waiting_;
    bool growing_ = false;
    bool ended_ = false;
    std::shared_ptr<const Growth> grown_;
    std::exception_ptr failed_;
    std::thread thread_;  // last: starts when all else is there
};

}  // namespace palpate::seeds
