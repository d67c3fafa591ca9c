// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate::seeds {

/// How labels are made from seeds.
struct Growing {
    /// Throws InvalidInput where nothing can be made of the seeds. An empty map where there is nothing to
    /// make.
    std::function<LabelMap(std::span<const imaging::Seed>)> labels_of;
    double block_mm = 0;  ///< edge of the blocks it works on; 0: the volume's own voxels
};

/// By grow_from_seeds() with preview_parameters(): labels compete, within a second. Keeps a reference to
/// `volume`.
Growing preview_growing(const Volume& volume);

/// By segment(), as the command will make them of a file with the same seeds: of `structures` those that have
/// a seed of their name or need none; grow-from-seeds takes seeds of other names for background. Keeps a
/// reference to `volume`.
Growing recipe_growing(const Volume& volume, std::vector<imaging::StructureRecipe> structures);

/// Whether seeds can be given to a structure's recipe.
bool takes_seeds(const imaging::StructureRecipe& structure);

/// What grew from some seeds.
struct Growth {
    LabelMap map;                   ///< empty without seeds
    std::vector<double> volume_ml;  ///< of each of map.names
    double block_mm = 0;            ///< how coarse it is: of Growing
    std::string refused;            ///< why nothing could be made of the seeds; empty: it could
    double seconds = 0;             ///< from asking to having
};

/// Grows labels beside the window. One growth at a time; of requests made meanwhile the last one counts.
class GrowthWorker {
  public:
    explicit GrowthWorker(Growing growing);
    GrowthWorker(const GrowthWorker&) = delete;
    GrowthWorker& operator=(const GrowthWorker&) = delete;
    /// Waits for the growth under way, drops the one waiting.
    ~GrowthWorker();

    /// Asks for a growth; returns at once.
    void request(std::vector<imaging::Seed> seeds);
    /// Tells whether something asked for has not been taken yet.
    bool busy() const;
    /// The latest growth since the last call, nothing if there is none; throws what growing threw besides
    /// InvalidInput.
    std::shared_ptr<const Growth> take();
    /// Waits until everything asked for has grown.
    void wait();

  private:
    struct Request {
        std::vector<imaging::Seed> seeds;
        std::chrono::steady_clock::time_point asked;
    };
    void work();

    Growing growing_by_;
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
