#include "formats/openmesh/om_structure.h"

#include <cstdint>
#include <cstring>

namespace prep::detail {
namespace {

enum Entity { vertices = 0, mesh = 1, faces = 2, edges = 4, halfedges = 6, sentinel = 7 };
enum Type {
    positions = 0,
    normals = 1,
    texcoords = 2,
    status = 3,
    color = 4,
    custom = 6,
    topology = 7
};

// Of the chunk with this head, which is a known one and has no name of its own.
std::string chunk_name(unsigned head) {
    static constexpr const char* entities[] = {"vertices'", "the mesh's", "faces'",      "",
                                               "edges'",    "",           "half-edges'", ""};
    static constexpr const char* types[16] = {
        "positions", "normals", "texture coordinates", "status", "colours", "", "property"};
    return std::string(entities[head >> 2 & 7]) + ' ' + types[head >> 5 & 15];
}

class Walker {
  public:
    Walker(std::span<const std::byte> bytes, const std::string& name)
        : bytes_(bytes), name_(name) {}

    Result<CheckedOm> run() {
        if (bytes_.size() < 16) return fail("the file is shorter than an OM header");
        if (byte(0) != 'O' || byte(1) != 'M')
            return fail("expected \"OM\" at the beginning: not an OM file");
        if (byte(2) != 'P' && byte(2) != 'T' && byte(2) != 'Q')
            return fail("expected P, T or Q for the kind of faces");
        if (byte(3) >> 5 != 2)
            return Error{ErrorCode::unsupported,
                         "OM version " + std::to_string(byte(3) >> 5) +
                             " is not supported, only 2: save it anew with OpenMesh 6 or later",
                         name_ + ", byte 3"};
        vertices_ = number(4);
        faces_ = number(8);
        edges_ = number(12);
        // A vertex takes 12 bytes (three floats), a face one, an edge six (two half-edges of
        // three).
        if (vertices_ > bytes_.size() / 12 || faces_ > bytes_.size() || edges_ > bytes_.size() / 6)
            return fail("the header announces " + std::to_string(vertices_) + " vertices, " +
                        std::to_string(faces_) + " faces and " + std::to_string(edges_) +
                        " edges, more than the file has room for");
        at_ = 16;
        keep(0, at_);
        while (left() >= 2) {
            const std::size_t begin = at_;
            const unsigned head = unsigned(byte(at_)) | unsigned(byte(at_ + 1)) << 8;
            at_ += 2;
            if ((head >> 2 & 7) == sentinel) {
                if (auto done = complete(); !done) return std::move(done).error();
                keep(begin, at_);
                return CheckedOm{std::move(kept_), std::move(left_out_)};
            }
            kind_ = Kind::other;
            if (auto done = chunk(head); !done) {
                at_ = begin;
                return fail(std::move(done).error().text);
            }
            if (kind_ == Kind::mesh)
                keep(begin, at_);
            else
                left_out_.add(own_name_.empty() ? chunk_name(head) : own_name_);
        }
        return fail("the file ends without its last chunk: it is cut short");
    }

  private:
    unsigned char byte(std::size_t i) const { return std::to_integer<unsigned char>(bytes_[i]); }
    std::uint64_t number(std::size_t i) const {
        std::uint32_t value;
        std::memcpy(&value, bytes_.data() + i, sizeof value);
        return value;
    }
    std::size_t left() const { return bytes_.size() - at_; }
    Error fail(std::string text) const {
        return {ErrorCode::syntax, std::move(text), name_ + ", byte " + std::to_string(at_)};
    }

    void keep(std::size_t begin, std::size_t end) {
        kept_.append(reinterpret_cast<const char*>(bytes_.data()) + begin, end - begin);
    }

    // OpenMesh adds the vertices when it reads their positions, and looks for them before without
    // asking whether they are there.
    Error before_positions() const {
        return fail(
            "vertices' normals, texture coordinates, colours or connectivity before their "
            "positions");
    }

    Result<void> complete() const {
        if (vertices_ > 0 && !have_positions_) return fail("the file has no positions");
        if (edges_ > 0 && !have_halfedges_) return fail("the file has no half-edges");
        if (faces_ > 0 && !have_faces_) return fail("the file has no faces");
        return {};
    }

    // A byte that says how long, and so many characters: the names of properties and their types.
    Result<std::string> short_text() {
        const std::size_t length = left() > 0 ? byte(at_) : 0;
        if (left() < 1 + length) return fail("a chunk's name is cut short");
        std::string text(reinterpret_cast<const char*>(bytes_.data()) + at_ + 1, length);
        at_ += 1 + length;
        return text;
    }

    Result<void> chunk(unsigned head) {
        const unsigned entity = head >> 2 & 7, type = head >> 5 & 15, dim = (head >> 11 & 7) + 1;
        const unsigned bits = head >> 14 & 3;
        const bool floats = head >> 10 & 1;
        const bool named = head >> 1 & 1;
        own_name_.clear();
        if (named) {
            auto own = short_text();
            if (!own) return std::move(own).error();
            own_name_ = *std::move(own);
            // Since 2.2 the name of its type follows.
            if ((byte(3) & 0x1f) >= 2)
                if (auto type_name = short_text(); !type_name) return std::move(type_name).error();
        }
        std::uint64_t count = 0;
        switch (entity) {
            case vertices:
                count = vertices_;
                break;
            case mesh:
                count = 1;
                break;
            case faces:
                count = faces_;
                break;
            case edges:
                count = edges_;
                break;
            case halfedges:
                count = 2 * edges_;
                break;
            default:
                return fail("a chunk of an unknown entity");
        }
        std::uint64_t size = 0;
        if (type == custom) {
            if (left() < 4) return fail("a property is cut short");
            size = number(at_);
            at_ += 4;
        } else if (type == topology) {
            if (named || dim != (entity == halfedges ? 3u : 1u))
                return fail("connectivity of an unknown kind");
            kind_ = Kind::mesh;
            return connect(entity, count, std::size_t(1) << bits);
        } else if (type == positions || type == normals || type == texcoords) {
            const bool known = entity == vertices || (entity == faces && type == normals) ||
                               (entity == halfedges && type != positions);
            if (!known || !floats || bits > 1 || dim != (type == texcoords ? 2u : 3u))
                return fail("positions, normals and texture coordinates of an unknown kind");
            if (entity == vertices && !named) {
                if (type == positions && have_positions_) return fail("positions a second time");
                have_positions_ |= type == positions;
                if (!have_positions_) return before_positions();
                // Its reader takes texture coordinates in double for triples, and ends the process.
                if (type == texcoords && bits != 0)
                    return fail("texture coordinates in double, which OpenMesh does not read");
                kind_ = Kind::mesh;
            }
            size = count * dim * (std::uint64_t(4) << bits);
        } else if (type == status || type == color) {
            if (type == color && (dim < 3 || dim > 4)) return fail("colours of an unknown kind");
            // OpenMesh writes a status as the 32 bits that it is, whatever the head says of bits.
            const std::uint64_t each = type == status ? 4
                                       : floats       ? std::uint64_t(4) << bits
                                                      : std::uint64_t(1) << bits;
            size = count * (type == color ? dim : 1) * each;
            if (type == color && entity == vertices && !named && dim == 3 && !floats && bits == 0) {
                if (!have_positions_) return before_positions();
                kind_ = Kind::mesh;
            }
        } else {
            return fail("a chunk of an unknown type");
        }
        if (size > left())
            return fail("a chunk of " + std::to_string(size) + " bytes, but only " +
                        std::to_string(left()) + " are left");
        at_ += size;
        return {};
    }

    // Signed integers of `width` bytes; −1 is none.
    bool index(std::size_t width, std::uint64_t count, bool none_allowed) {
        std::int64_t value = 0;
        std::memcpy(&value, bytes_.data() + at_, width);
        at_ += width;
        const unsigned shift = unsigned(64 - 8 * width);
        value = std::int64_t(std::uint64_t(value) << shift) >> shift;
        return value == -1 ? none_allowed : value >= 0 && std::uint64_t(value) < count;
    }

    Result<void> connect(unsigned entity, std::uint64_t count, std::size_t width) {
        const unsigned each = entity == halfedges ? 3 : 1;
        if (entity != halfedges && entity != vertices && entity != faces)
            return fail("connectivity of an unknown kind");
        bool& have = entity == halfedges  ? have_halfedges_
                     : entity == vertices ? have_outgoing_
                                          : have_faces_;
        if (have) return fail("connectivity a second time");
        if (entity == vertices && !have_positions_) return before_positions();
        have = true;
        if (count * each * width > left())
            return fail("connectivity of " + std::to_string(count * each * width) +
                        " bytes, but only " + std::to_string(left()) + " are left");
        for (std::uint64_t i = 0; i < count; ++i) {
            const bool good = entity == halfedges
                                  ? index(width, 2 * edges_, false) &&
                                        index(width, vertices_, false) && index(width, faces_, true)
                                  : index(width, 2 * edges_, entity == vertices);
            if (!good)
                return fail("an index of the connectivity is out of range, in element " +
                            std::to_string(i));
        }
        return {};
    }

    enum class Kind { other, mesh };

    std::span<const std::byte> bytes_;
    const std::string& name_;
    std::string kept_;
    NameList left_out_;
    std::string own_name_;     // of the chunk being read
    Kind kind_ = Kind::other;  // of the chunk being read
    std::size_t at_ = 0;
    std::uint64_t vertices_ = 0, faces_ = 0, edges_ = 0;
    bool have_positions_ = false, have_halfedges_ = false, have_outgoing_ = false,
         have_faces_ = false;
};

}  // namespace

Result<CheckedOm> checked_om(std::span<const std::byte> bytes, const std::string& name) {
    return Walker(bytes, name).run();
}

}  // namespace prep::detail
