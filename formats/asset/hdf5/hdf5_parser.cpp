// SPDX-License-Identifier: Apache-2.0
// Section numbers are those of The HDF Group's "HDF5 File Format Specification Version 3.0".
#include "formats/asset/hdf5/hdf5_parser.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "formats/asset/hdf5/byte_cursor.hpp"
#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::uint64_t undefined_address = ~std::uint64_t{0};
constexpr std::size_t checksum_size = 4;
constexpr int deepest_group = 16;
constexpr std::size_t most_objects = 65536;
constexpr std::size_t longest_name = 64, longest_path = 255;
constexpr std::size_t highest_rank = 8;

enum Message : unsigned {  // IV.A.2
    nil = 0x00,
    dataspace = 0x01,
    link_info = 0x02,
    datatype = 0x03,
    fill_value = 0x05,
    link = 0x06,
    external_files = 0x07,
    data_layout = 0x08,
    group_info = 0x0A,
    filter_pipeline = 0x0B,
    attribute = 0x0C,
    continuation = 0x10,
    symbol_table = 0x11,
    attribute_info = 0x15,
    reference_count = 0x16
};

struct ElementType {
    ScalarType scalar;
    std::size_t size;
};

// What the messages of one object header add up to.
struct Header {
    std::vector<std::pair<std::string, std::uint64_t>> links;  // name, address
    std::optional<Hdf5Shape> shape;
    std::optional<ElementType> type;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> storage;  // address, size
    std::map<std::string, Hdf5Array> attributes;
};

std::string text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class Parser {
  public:
    Parser(Bytes file, const std::string& file_name)
        : file_(file), file_name_(file_name), unclaimed_(file.size()) {}

    std::map<std::string, Hdf5Object> parse() {
        try {
            add_object("/", superblock(), 0);
        } catch (const EndOfBytes&) {
            refuse("has a header that breaks off", "", "the file is damaged; copy or make it again");
        }
        return std::move(objects_);
    }

  private:
    [[noreturn]] void refuse(
        const std::string& found, const std::string& expected = "",
        const std::string& next_step =
            "use the file as palpate wrote it, or make it again with 'palpate pack'") const {
        throw InvalidInput(
            {where_.empty() ? file_name_ : file_name_ + ": " + where_, found, expected, next_step});
    }

    Bytes extent(std::uint64_t address, std::uint64_t size) const {
        if (address > file_.size() || size > file_.size() - address)
            refuse("lies beyond the end of the file", std::to_string(file_.size()) + " bytes");
        return file_.subspan(static_cast<std::size_t>(address), static_cast<std::size_t>(size));
    }

    // As extent(), for what belongs to one object alone: all of it together is no larger than the file, so
    // that neither time nor memory can be, whoever reads it all.
    Bytes claim(std::uint64_t address, std::uint64_t size) {
        const Bytes bytes = extent(address, size);
        if (size > unclaimed_) refuse("shares its bytes with other objects", "bytes of its own");
        unclaimed_ -= bytes.size();
        return bytes;
    }

    void check_checksum(Bytes block) const {
        ByteCursor stored(block.last(checksum_size));
        if (stored.number<std::uint32_t>() != lookup3(block.first(block.size() - checksum_size)))
            refuse("a header does not match its checksum", "", "the file is damaged; copy or make it again");
    }

    // II.A. Returns the root group's address.
    std::uint64_t superblock() const {
        constexpr std::array<unsigned char, 8> signature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
        constexpr std::size_t size = 48;
        if (file_.size() < signature.size() ||
            !std::ranges::equal(file_.first(signature.size()), std::as_bytes(std::span(signature))))
            refuse("is not an HDF5 file", "", "give an asset (.vtkhdf) or a part that palpate wrote");
        ByteCursor cursor(file_.subspan(signature.size()));
        const unsigned version = cursor.remaining() > 0 ? cursor.number<std::uint8_t>() : 3U;
        if (version != 2 && version != 3)
            refuse("HDF5 superblock version " + std::to_string(version), "2 or 3");
        if (file_.size() < size)
            refuse("is truncated: " + std::to_string(file_.size()) + " bytes", "", "copy or make it again");
        check_checksum(file_.first(size));
        const unsigned offset_size = cursor.number<std::uint8_t>();
        const unsigned length_size = cursor.number<std::uint8_t>();
        const unsigned open_flags = cursor.number<std::uint8_t>();
        const auto base = cursor.number<std::uint64_t>();
        const auto extension = cursor.number<std::uint64_t>();
        const auto end = cursor.number<std::uint64_t>();
        if (offset_size != 8 || length_size != 8 || base != 0 || extension != undefined_address)
            refuse("has an HDF5 superblock of another kind than palpate's");
        if (end != file_.size())
            refuse((end > file_.size() ? "is truncated: " : "has foreign bytes at its end: ") +
                       std::to_string(file_.size()) + " bytes",
                   std::to_string(end), "copy or make it again");
        if (open_flags != 0) refuse("was not closed by its writer", "", "make it again");
        return cursor.number<std::uint64_t>();
    }

    void add_object(const std::string& path, std::uint64_t address, int depth) {
        where_ = path;
        if (depth > deepest_group) refuse("groups are nested too deeply", std::to_string(deepest_group));
        if (path.size() > longest_path)
            refuse("has a path that is too long", std::to_string(longest_path) + " bytes");
        Header header = object_header(address);
        Hdf5Object object;
        object.attributes = std::move(header.attributes);
        if (header.type || header.shape || header.storage) {
            if (!header.type || !header.shape || !header.storage)
                refuse("lacks its type, its shape or its storage");
            if (!header.links.empty()) refuse("is a dataset with links");
            object.values = Hdf5Array{header.type->scalar, header.type->size, *header.shape, {}};
            if (header.type->scalar == ScalarType::variable_text && !path.starts_with("/VTKHDF/FieldData/"))
                refuse("is text of variable length", "text of fixed length");
            const std::uint64_t size = byte_count(*object.values);
            const auto [start, stored] = *header.storage;
            if (stored != size) refuse("stores " + std::to_string(stored) + " bytes", std::to_string(size));
            if (size > 0) {
                if (start % 8 != 0) refuse("does not start on an 8-byte boundary");
                object.values->bytes = claim(start, size);
            }
        }
        if (!objects_.emplace(path, std::move(object)).second) refuse("occurs twice");
        if (objects_.size() > most_objects) refuse("is one object too many", std::to_string(most_objects));
        for (const auto& [name, target] : header.links)
            add_object((path == "/" ? path : path + "/") + name, target, depth + 1);
    }

    // Bytes an array takes up; refuses one that cannot be in the file.
    std::uint64_t byte_count(const Hdf5Array& array) const {
        std::uint64_t size = array.element_size;
        for (const std::uint64_t dim : array.shape) {
            if (dim != 0 && size > file_.size() / dim)
                refuse("is larger than the file", "at most " + std::to_string(file_.size()) + " bytes");
            size *= dim;
        }
        return size;
    }

    // IV.A.1.b, version 2.
    Header object_header(std::uint64_t address) {
        if (!visited_.insert(address).second) refuse("is linked to twice");
        if (text_of(extent(address, 4)) != "OHDR") refuse("has no object header of version 2");
        ByteCursor cursor(extent(address, file_.size() - address).subspan(4));
        if (cursor.number<std::uint8_t>() != 2) refuse("has no object header of version 2");
        const unsigned flags = cursor.number<std::uint8_t>();
        if (flags & 0x20U) cursor.take(16);  // times
        if (flags & 0x10U) cursor.take(4);   // attribute phase change
        const std::uint64_t size = cursor.sized_number(flags);
        const std::size_t prefix = file_.size() - static_cast<std::size_t>(address) - cursor.remaining();
        cursor.take(size);
        check_checksum(claim(address, prefix + size + checksum_size));

        Header header;
        std::vector<Bytes> chunks{extent(address + prefix, size)};
        for (std::size_t i = 0; i < chunks.size(); ++i)
            for (ByteCursor chunk(chunks[i]); chunk.remaining() >= message_prefix(flags);)
                read_message(chunk, flags, header, chunks);
        return header;
    }

    static std::size_t message_prefix(unsigned header_flags) { return header_flags & 0x04U ? 6 : 4; }

    void read_message(ByteCursor& chunk, unsigned header_flags, Header& header, std::vector<Bytes>& chunks) {
        const unsigned type = chunk.number<std::uint8_t>();
        const auto size = chunk.number<std::uint16_t>();
        const unsigned flags = chunk.number<std::uint8_t>();
        if (header_flags & 0x04U) chunk.take(2);  // creation order
        if (flags & 0x02U) refuse("has a shared header message");
        ByteCursor body(chunk.take(size));
        switch (type) {
            case nil:
            case fill_value:
            case group_info:
                break;
            case dataspace:
                header.shape = read_shape(body);
                break;
            case datatype:
                header.type = read_type(body);
                break;
            case data_layout:
                header.storage = read_layout(body);
                break;
            case link:
                header.links.push_back(read_link(body));
                break;
            case attribute:
                read_attribute(body, header);
                break;
            case link_info:
                refuse_dense(body, 8, "links");
                break;
            case attribute_info:
                refuse_dense(body, 2, "attributes");
                break;
            case continuation:
                chunks.push_back(read_continuation(body));
                break;
            case external_files:
                refuse("keeps its data in external files", "contiguous data in this file");
            case filter_pipeline:
                refuse("is filtered (compressed)", "contiguous data without filters");
            case symbol_table:
                refuse("is a group of the old kind", "a group of version 2");
            case reference_count:
                refuse("is linked to twice");
            default:
                refuse("has a header message of unknown type " + std::to_string(type));
        }
    }

    // IV.A.1.b, continuation block.
    Bytes read_continuation(ByteCursor& body) {
        const auto address = body.number<std::uint64_t>();
        const auto size = body.number<std::uint64_t>();
        if (!visited_.insert(address).second) refuse("has a header that continues in itself");
        const Bytes block = claim(address, size);
        if (block.size() < 4 + checksum_size || text_of(block.first(4)) != "OCHK")
            refuse("has a header that breaks off", "", "the file is damaged; copy or make it again");
        check_checksum(block);
        return block.subspan(4, block.size() - 4 - checksum_size);
    }

    // IV.A.2.b, version 2.
    Hdf5Shape read_shape(ByteCursor& body) const {
        const unsigned version = body.number<std::uint8_t>();
        const std::size_t rank = body.number<std::uint8_t>();
        body.take(1);  // whether there are largest sizes; contiguous data cannot grow anyway
        const unsigned kind = body.number<std::uint8_t>();
        if (version != 2 || kind > 1 || rank > highest_rank)
            refuse("has a dataspace of another kind than palpate's");
        Hdf5Shape shape(rank);
        for (std::uint64_t& dim : shape) dim = body.number<std::uint64_t>();
        return shape;
    }

    // IV.A.2.d. Only the little-endian standard types and text of fixed length are known.
    ElementType read_type(ByteCursor& body) const {
        const unsigned kind = body.number<std::uint8_t>() & 0x0FU;
        const std::array<unsigned, 3> bits{body.number<std::uint8_t>(), body.number<std::uint8_t>(),
                                           body.number<std::uint8_t>()};
        const auto size = body.number<std::uint32_t>();
        const Bytes properties = body.take(body.remaining());
        const auto matches = [&](std::initializer_list<unsigned> expected) {
            return properties.size() >= expected.size() &&
                   std::equal(expected.begin(), expected.end(), properties.begin(),
                              [](unsigned a, std::byte b) { return a == std::to_integer<unsigned>(b); });
        };
        if (kind == 0 && bits[0] == 0x00 && size == 1 && matches({0, 0, 8, 0})) return {ScalarType::uint8, 1};
        if (kind == 0 && bits[0] == 0x08 && size == 2 && matches({0, 0, 16, 0}))
            return {ScalarType::int16, 2};
        if (kind == 0 && bits[0] == 0x08 && size == 4 && matches({0, 0, 32, 0}))
            return {ScalarType::int32, 4};
        if (kind == 0 && bits[0] == 0x08 && size == 8 && matches({0, 0, 64, 0}))
            return {ScalarType::int64, 8};
        if (kind == 1 && bits[0] == 0x20 && bits[1] == 31 && size == 4 &&
            matches({0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0}))
            return {ScalarType::float32, 4};
        if (kind == 1 && bits[0] == 0x20 && bits[1] == 63 && size == 8 &&
            matches({0, 0, 64, 0, 52, 11, 0, 52, 0xFF, 0x03, 0, 0}))
            return {ScalarType::float64, 8};
        if (kind == 3 && size > 0) return {ScalarType::text, size};
        if (kind == 9 && (bits[0] & 0x0FU) == 1 && size == 16) return {ScalarType::variable_text, size};
        refuse("has a type of class " + std::to_string(kind) + " and size " + std::to_string(size),
               "uint8, int16, int32, int64, float32, float64 (little-endian) or text of fixed length");
    }

    // IV.A.2.i.
    std::pair<std::uint64_t, std::uint64_t> read_layout(ByteCursor& body) const {
        const unsigned version = body.number<std::uint8_t>();
        const unsigned kind = body.number<std::uint8_t>();
        constexpr unsigned contiguous = 1;
        constexpr std::array<const char*, 4> names{"compact", "contiguous", "chunked", "virtual"};
        if (version != 3 && version != 4) refuse("has a data layout of version " + std::to_string(version));
        if (kind != contiguous)
            refuse(std::string("is ") + (kind < names.size() ? names[kind] : "of unknown layout"),
                   "contiguous");
        const auto address = body.number<std::uint64_t>();
        return {address, body.number<std::uint64_t>()};
    }

    // IV.A.2.g.
    std::pair<std::string, std::uint64_t> read_link(ByteCursor& body) const {
        const unsigned version = body.number<std::uint8_t>();
        const unsigned flags = body.number<std::uint8_t>();
        const unsigned type = flags & 0x08U ? body.number<std::uint8_t>() : 0U;
        if (flags & 0x04U) body.take(8);  // creation order
        if (flags & 0x10U) body.take(1);  // character set
        const std::string name = text_of(body.take(body.sized_number(flags)));
        if (version != 1 || !plain_name(name)) refuse("has a link of another kind than palpate's");
        if (type != 0)
            refuse("link '" + name + "' is " +
                       (type == 1    ? "soft"
                        : type == 64 ? "external"
                                     : "user-defined"),
                   "a hard link");
        return {name, body.number<std::uint64_t>()};
    }

    // IV.A.2.m, version 3.
    void read_attribute(ByteCursor& body, Header& header) const {
        const unsigned version = body.number<std::uint8_t>();
        const unsigned shared = body.number<std::uint8_t>();
        if (version != 3 || shared != 0) refuse("has an attribute of another kind than palpate's");
        const std::uint64_t name_size = body.number<std::uint16_t>();
        const std::uint64_t type_size = body.number<std::uint16_t>();
        const std::uint64_t space_size = body.number<std::uint16_t>();
        body.take(1);  // character set of the name
        std::string name = text_of(body.take(name_size));
        if (!name.empty() && name.back() == '\0') name.pop_back();
        if (!plain_name(name)) refuse("has an attribute without a plain name");
        ByteCursor type_bytes(body.take(type_size)), space_bytes(body.take(space_size));
        const ElementType type = read_type(type_bytes);
        if (type.scalar == ScalarType::variable_text)
            refuse("has attribute '" + name + "' of variable length", "text of fixed length");
        Hdf5Array array{type.scalar, type.size, read_shape(space_bytes), {}};
        array.bytes = body.take(byte_count(array));
        if (!header.attributes.emplace(name, std::move(array)).second)
            refuse("has two attributes '" + name + "'");
    }

    // IV.A.2.c and IV.A.2.v: an index outside the header would begin with a fractal heap.
    void refuse_dense(ByteCursor& body, std::size_t order_size, const std::string& what) const {
        body.take(1);  // version
        if (body.number<std::uint8_t>() & 0x01U) body.take(order_size);
        if (body.number<std::uint64_t>() != undefined_address)
            refuse("keeps its " + what + " outside its header");
    }

    static bool plain_name(const std::string& name) {
        return !name.empty() && name.size() <= longest_name && std::ranges::all_of(name, [](char c) {
            return c > ' ' && c < '\x7f' && c != '/' && c != '@';
        });
    }

    Bytes file_;
    std::string file_name_;
    std::uint64_t unclaimed_;  // bytes of the file that no object has yet
    std::string where_;
    std::set<std::uint64_t> visited_;
    std::map<std::string, Hdf5Object> objects_;
};

}  // namespace

std::map<std::string, Hdf5Object> parse_hdf5(std::span<const std::byte> bytes, const std::string& file_name) {
    return Parser(bytes, file_name).parse();
}

}  // namespace palpate::asset
