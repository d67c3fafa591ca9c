// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/growth.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/voxels/grow_from_seeds.hpp"

namespace palpate::seeds {
namespace {

using namespace imaging;

Growth grow(const Growing& growing, const std::vector<Seed>& seeds) {
    Growth growth;
    growth.block_mm = growing.block_mm;
    if (seeds.empty()) return growth;
    try {
        growth.map = growing.labels_of(seeds);
    } catch (const InvalidInput& refusal) {
        growth.refused = refusal.what();
        return growth;
    }
    std::vector<std::size_t> voxels(growth.map.names.size() + 1, 0);  // labels count up from 1
    for (const std::uint16_t label : growth.map.labels) ++voxels[label];
    for (const Label& label : growth.map.names)
        growth.volume_ml.push_back(static_cast<double>(voxels[label.value]) * growth.map.grid.voxel_volume() /
                                   1000);
    return growth;
}

// Gives a structure the places of the seeds that bear its name, whatever their case, or of all others.
void give_seeds(StructureRecipe& structure, std::span<const Seed> seeds, bool own,
                const std::string& parameter) {
    const Recipe* recipe = find_recipe(structure.recipe);
    if (recipe == nullptr || find_parameter(*recipe, parameter) == nullptr) return;
    std::vector<double> numbers;
    for (const Seed& seed : seeds)
        if (same_label(seed.label, structure.name) == own)
            numbers.insert(numbers.end(), seed.p_P.begin(), seed.p_P.end());
    if (!numbers.empty()) structure.parameters[parameter] = std::move(numbers);
}

bool has_seeds(const StructureRecipe& structure) {
    return std::ranges::any_of(std::array{"seeds_mm", "seeds_file", "scribbles"},
                               [&](const char* name) { return structure.parameters.contains(name); });
}

LabelMap segmented(const Volume& volume, std::vector<StructureRecipe> structures,
                   std::span<const Seed> seeds) {
    std::erase_if(structures, [&](StructureRecipe& structure) {
        give_seeds(structure, seeds, true, "seeds_mm");
        give_seeds(structure, seeds, false,
                   "background_mm");  // of them, segment() leaves out its rivals' own
        const Recipe* recipe = find_recipe(structure.recipe);
        return recipe != nullptr && recipe->needs_seeds && !has_seeds(structure);
    });
    return structures.empty() ? LabelMap{} : segment(&volume, nullptr, structures);
}

}  // namespace

Growing preview_growing(const Volume& volume) {
    const GrowParameters parameters = preview_parameters(volume.grid);
    return {[&volume, parameters](std::span<const Seed> seeds) {
                return grow_from_seeds(volume, seeds, parameters);
            },
            parameters.spacing_mm};
}

Growing recipe_growing(const Volume& volume, std::vector<StructureRecipe> structures) {
    return {[&volume, structures = std::move(structures)](std::span<const Seed> seeds) {
                return segmented(volume, structures, seeds);
            },
            0};
}

bool takes_seeds(const StructureRecipe& structure) {
    const Recipe* recipe = find_recipe(structure.recipe);
    return recipe != nullptr && find_parameter(*recipe, "seeds_mm") != nullptr;
}

GrowthWorker::GrowthWorker(Growing growing) : growing_by_(std::move(growing)), thread_([this] { work(); }) {}

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
            growth = std::make_shared<Growth>(grow(growing_by_, request.seeds));
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
