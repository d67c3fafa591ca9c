// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/hdf5_mutator.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/asset/hdf5/byte_cursor.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/hdf5/hdf5_parser.hpp"
#include "formats/model/errors.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace palpate::fuzz {
namespace {

using asset::Hdf5Array;
using Objects = std::map<std::string, asset::Hdf5Object>;
using Bytes = std::span<std::uint8_t>;

constexpr std::size_t superblock_size = 44, end_of_file_field = 28;

template <typename T>
T number_at(Bytes bytes, std::size_t at) {
    T value;
    std::memcpy(&value, &bytes[at], sizeof(T));
    return value;
}

template <typename T>
void put(Bytes bytes, std::size_t at, T value) {
    std::memcpy(&bytes[at], &value, sizeof(T));
}

// Superblock, object headers and their continuations, without their checksums, which follow them.
class Blocks {
  public:
    explicit Blocks(Bytes file) : file_(file) {
        if (file.size() >= superblock_size + 4) found_.push_back(file.first(superblock_size));
        const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
        for (std::size_t at = text.find("OHDR"); at != std::string_view::npos; at = text.find("OHDR", at + 1))
            if (at + 8 < text.size()) add_header(at);
    }

    const std::vector<Bytes>& found() const { return found_; }

    void renew_checksums() const {
        for (const Bytes block : found_) {
            const std::uint32_t sum = asset::lookup3(std::as_bytes(block));
            std::memcpy(block.data() + block.size(), &sum, sizeof(sum));
        }
    }

  private:
    bool add(std::size_t at, std::uint64_t size) {
        if (at > file_.size() || size > file_.size() - at || file_.size() - at - size < 4) return false;
        if (!starts_.insert(at).second) return false;
        found_.push_back(file_.subspan(at, size));
        return true;
    }

    void add_header(std::size_t at) {
        const unsigned flags = file_[at + 5];
        const std::size_t size_field = at + 6 + (flags & 0x20U ? 16 : 0) + (flags & 0x10U ? 4 : 0);
        const std::size_t width = std::size_t{1} << (flags & 3U);
        if (size_field + width > file_.size()) return;
        std::uint64_t size = 0;
        std::memcpy(&size, &file_[size_field], width);
        const std::size_t first = size_field + width;
        if (size > file_.size() || !add(at, first - at + size)) return;
        add_continuations(first, size, flags);
    }

    void add_continuations(std::size_t at, std::size_t size, unsigned flags) {
        const std::size_t prefix = flags & 0x04U ? 6 : 4, end = at + size;
        constexpr std::uint8_t continuation = 0x10;
        while (at + prefix <= end) {
            const std::size_t body = at + prefix, length = number_at<std::uint16_t>(file_, at + 1);
            if (file_[at] == continuation && body + 16 <= end) {
                const auto address = number_at<std::uint64_t>(file_, body),
                           whole = number_at<std::uint64_t>(file_, body + 8);
                if (whole >= 8 && add(address, whole - 4)) add_continuations(address + 4, whole - 8, flags);
            }
            at = body + length;
        }
    }

    Bytes file_;
    std::vector<Bytes> found_;
    std::set<std::size_t> starts_;
};

Objects objects_of(Bytes file) {
    try {
        return asset::parse_hdf5(std::as_bytes(file), "fuzzed");
    } catch (const InvalidInput&) {
        return {};
    }
}

// The arrays point into the file, which is ours to change.
Bytes writable(const Hdf5Array& array) {
    return {reinterpret_cast<std::uint8_t*>(const_cast<std::byte*>(array.bytes.data())), array.bytes.size()};
}

class Digests {
  public:
    explicit Digests(const Objects& objects) : objects_(objects) {}

    void renew() const {
        for (const auto& [path, object] : objects_)
            if (object.values) put_text(path, "sha256", asset::sha256(object.values->bytes));
        for (const auto& [path, object] : objects_) {
            put_text(path, "surface_sha256", surface(path));
            put_text(path, "mechanics_sha256", mechanics(path));
        }
        put_text("/palpate", "manifest_sha256", manifest());
    }

  private:
    const Hdf5Array* values(const std::string& path) const {
        const auto found = objects_.find(path);
        return found != objects_.end() && found->second.values ? &*found->second.values : nullptr;
    }

    void put_text(const std::string& path, const std::string& name, const std::string& text) const {
        const auto object = objects_.find(path);
        if (object == objects_.end() || !object->second.attributes.contains(name)) return;
        const Bytes bytes = writable(object->second.attributes.at(name));
        std::copy_n(text.begin(), std::min(text.size(), bytes.size()), bytes.begin());
    }

    static std::string parent(const std::string& path) { return path.substr(0, path.rfind('/')); }

    std::string surface(const std::string& tree) const {
        const std::string body = parent(tree);
        const Hdf5Array* vertices = values(body + "/vertices");
        const Hdf5Array* triangles = values(body + "/triangles");
        std::vector<std::byte> places;
        if (vertices != nullptr) {
            places.assign(vertices->bytes.begin(), vertices->bytes.end());
        } else if (values(body + "/surface_nodes") != nullptr &&
                   values(body + "/rest_positions") != nullptr) {
            triangles = values(body + "/surface_triangles");
            const auto nodes = values(body + "/surface_nodes")->bytes,
                       rest = values(body + "/rest_positions")->bytes;
            constexpr std::size_t row = 3 * sizeof(double);
            for (std::size_t at = 0; at + 4 <= nodes.size(); at += 4) {
                std::int32_t node = 0;
                std::memcpy(&node, &nodes[at], sizeof(node));
                if (node < 0 || (static_cast<std::size_t>(node) + 1) * row > rest.size()) return "";
                const auto place = rest.subspan(static_cast<std::size_t>(node) * row, row);
                places.insert(places.end(), place.begin(), place.end());
            }
        }
        if (triangles == nullptr) return "";
        return asset::sha256("vertices " + asset::sha256(places) + "\ntriangles " +
                             asset::sha256(triangles->bytes) + "\n");
    }

    std::string mechanics(const std::string& compliance) const {
        const std::string body = parent(compliance);
        std::string text;
        for (const char* name : {"rest_positions", "tetrahedra", "regions", "material_regions", "materials",
                                 "relaxation_regions", "relaxation", "fixed_nodes", "contact_nodes"}) {
            const Hdf5Array* array = values(body + "/" + name);
            if (array == nullptr || (array->bytes.empty() && std::string_view(name).starts_with("relax")))
                continue;
            text += std::string(name) + " " + asset::sha256(array->bytes) + "\n";
        }
        const auto found = objects_.find(body);
        if (found == objects_.end() || !found->second.attributes.contains("element_order")) return "";
        const auto order = found->second.attributes.at("element_order").bytes;
        std::int32_t number = 0;
        std::memcpy(&number, order.data(), std::min(order.size(), sizeof(number)));
        return asset::sha256(text + "element_order " + std::to_string(number) + "\n");
    }

    std::string manifest() const {
        std::map<std::string, std::string> lines;
        for (const auto& [path, object] : objects_) {
            if (object.values && object.values->type != asset::ScalarType::variable_text)
                lines[path] = asset::sha256(object.values->bytes);
            for (const auto& [name, array] : object.attributes)
                if (asset::in_manifest(name)) lines[path + '@' + name] = asset::sha256(array.bytes);
        }
        return asset::manifest_digest(lines);
    }

    const Objects& objects_;
};

class Mutation {
  public:
    Mutation(Bytes file, unsigned seed) : file_(file), random_(seed) {}

    void change_header() {
        const Blocks blocks(file_);
        if (!blocks.found().empty()) damage(blocks.found()[below(blocks.found().size())]);
    }

    void change_values() {
        std::vector<Bytes> arrays;
        for (const auto& [path, object] : objects_of(file_)) {
            if (object.values && !object.values->bytes.empty()) arrays.push_back(writable(*object.values));
            for (const auto& [name, array] : object.attributes)
                if (!array.bytes.empty()) arrays.push_back(writable(array));
        }
        if (!arrays.empty()) damage(arrays[below(arrays.size())]);
    }

    // Gives a dataset another number of rows, in its shape and in its layout.
    void change_length() {
        std::vector<Hdf5Array> arrays;
        for (const auto& [path, object] : objects_of(file_))
            if (object.values && !object.values->bytes.empty() && !object.values->shape.empty())
                arrays.push_back(*object.values);
        if (arrays.empty()) return;
        const Hdf5Array& array = arrays[below(arrays.size())];
        const std::uint64_t rows = array.shape[0], size = array.bytes.size(), row = size / rows;
        const std::uint64_t wanted = below(2) == 0 ? below(rows + 1) : rows + 1 + below(4);
        const auto start = static_cast<std::uint64_t>(writable(array).data() - file_.data());
        const Blocks blocks(file_);
        for (const Bytes block : blocks.found()) {
            const auto layout = place_of(block, start, size);
            if (layout == block.size()) continue;
            put(block, layout + 8, wanted * row);
            for (std::size_t at = 0; at + 8 <= block.size(); ++at)
                if (at != layout + 8 && number_at<std::uint64_t>(block, at) == rows) {
                    put(block, at, wanted);
                    return;
                }
        }
    }

  private:
    static std::size_t place_of(Bytes block, std::uint64_t address, std::uint64_t size) {
        for (std::size_t at = 0; at + 16 <= block.size(); ++at)
            if (number_at<std::uint64_t>(block, at) == address &&
                number_at<std::uint64_t>(block, at + 8) == size)
                return at;
        return block.size();
    }

    std::uint64_t below(std::uint64_t end) {
        return std::uniform_int_distribution<std::uint64_t>(0, end - 1)(random_);
    }

    void damage(Bytes bytes) {
        constexpr std::array<std::uint64_t, 8> telling{
            0, 1, ~0ULL, 1ULL << 31, 1ULL << 32, 1ULL << 62, 1ULL << 63, 0x7FF8000000000000};
        if (below(2) == 0) {
            LLVMFuzzerMutate(bytes.data(), bytes.size(), bytes.size());
            return;
        }
        for (std::uint64_t times = 1 + below(3); times > 0; --times) {
            const std::size_t at = below(bytes.size());
            const std::size_t width = std::min<std::size_t>(std::size_t{1} << below(4), bytes.size() - at);
            if (below(2) == 0) {
                std::memcpy(&bytes[at], &telling[below(telling.size())], width);
            } else {  // another place's bytes: an index that is in range, a number of the right kind
                const std::size_t from = below(bytes.size() - width + 1);
                std::memmove(&bytes[at], &bytes[from], width);
            }
        }
    }

    Bytes file_;
    std::mt19937 random_;
};

}  // namespace

std::size_t mutated_hdf5(std::span<std::uint8_t> buffer, std::size_t size, unsigned seed) {
    Mutation mutation(buffer.first(size), seed);
    switch (seed % 8) {
        case 0:
            return LLVMFuzzerMutate(buffer.data(), size, buffer.size());
        case 1:
            size = LLVMFuzzerMutate(buffer.data(), size, buffer.size());
            if (size >= superblock_size) put(buffer, end_of_file_field, std::uint64_t{size});
            break;
        case 2:
        case 3:
            mutation.change_header();
            break;
        case 4:
            mutation.change_length();
            break;
        default:
            mutation.change_values();
    }
    const Bytes file = buffer.first(size);
    Blocks(file).renew_checksums();
    Digests(objects_of(file)).renew();
    Blocks(file).renew_checksums();
    return size;
}

}  // namespace palpate::fuzz
