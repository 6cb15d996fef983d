// What a process and its reader say to each other over a socket: a request, then its answer. Both
// begin with a header of fixed size; whoever gets one holds it against its own build.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "prep/load.h"
#include "prep/result.h"

namespace prep::detail {

// The socket's number in the reader's process. Its standard output and error are one pipe.
constexpr int reader_socket = 3;

// What is asked for and what comes back: a scene or a picture, an error, that there is no memory.
enum class MessageKind : std::uint32_t {
    request,
    scene,
    error,
    out_of_memory,
    picture_request,
    picture
};

struct MessageHeader {
    std::uint64_t build = 0;  // whether both mean the same by the same bytes
    MessageKind kind = MessageKind::request;
    std::uint32_t unused = 0;
    std::uint64_t size = 0;  // of what follows
};

// The header of a message of this build.
MessageHeader message_header(MessageKind kind, std::size_t size);
bool is_of_this_build(const MessageHeader& header);

// Which file, and what its reader may take.
struct RequestedFile {
    std::filesystem::path path;       // as the caller gave it: it stands in messages and scenes
    std::filesystem::path directory;  // what it is relative to; empty: unknown
    double seconds = 0;               // of processor time; 0: no limit
    std::uint64_t memory = 0;         // bytes; 0: no limit
};

struct ReadRequest {
    std::string format;  // FileFormat::name
    RequestedFile file;
    LoadOptions options;  // but for the process and its log
};

struct PictureRequest {
    RequestedFile file;
    bool all_channels = false;  // ImageChannels::all
};

std::vector<std::byte> request_bytes(const ReadRequest& request);
std::vector<std::byte> request_bytes(const PictureRequest& request);
std::vector<std::byte> error_bytes(const Error& error);
// False where the bytes are none.
bool request_of_bytes(std::span<const std::byte> bytes, ReadRequest& request);
bool request_of_bytes(std::span<const std::byte> bytes, PictureRequest& request);
bool error_of_bytes(std::span<const std::byte> bytes, Error& error);

// Both return false where the other side is gone, and raise no signal.
bool send_all(int socket, const void* from, std::size_t size);
bool receive_all(int socket, void* to, std::size_t size);

}  // namespace prep::detail
