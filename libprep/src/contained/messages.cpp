#include "contained/messages.h"

#include <sys/socket.h>

#include <cerrno>

#include "contained/bytes.h"

namespace prep::detail {

template <class List, Is<LoadOptions> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.threads, t.texture_directories, t.transparency, t.allowed_extensions,
                   LeftOut{} /* reader_process */, LeftOut{} /* reader_log */);
}

template <class List, Is<RequestedFile> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.path, t.directory, t.seconds, t.memory);
}

template <class List, Is<ReadRequest> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.format, t.file, t.options);
}

template <class List, Is<PictureRequest> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.file, t.all_channels);
}

template <class List, Is<Error> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.code, t.text, t.place);
}

MessageHeader message_header(MessageKind kind, std::size_t size) {
    return {MESHPREP_READER_BUILD, kind, 0, size};
}

bool is_of_this_build(const MessageHeader& header) {
    return header.build == MESHPREP_READER_BUILD;
}

std::vector<std::byte> request_bytes(const ReadRequest& request) {
    ByteWriter writer;
    writer(request);
    return writer.take();
}

std::vector<std::byte> request_bytes(const PictureRequest& request) {
    ByteWriter writer;
    writer(request);
    return writer.take();
}

std::vector<std::byte> error_bytes(const Error& error) {
    ByteWriter writer;
    writer(error);
    return writer.take();
}

bool request_of_bytes(std::span<const std::byte> bytes, ReadRequest& request) {
    ByteReader reader(bytes);
    reader(request);
    return reader.good() && reader.at_end();
}

bool request_of_bytes(std::span<const std::byte> bytes, PictureRequest& request) {
    ByteReader reader(bytes);
    reader(request);
    return reader.good() && reader.at_end();
}

bool error_of_bytes(std::span<const std::byte> bytes, Error& error) {
    ByteReader reader(bytes);
    reader(error);
    return reader.good() && reader.at_end();
}

bool send_all(int socket, const void* from, std::size_t size) {
    const auto* at = static_cast<const std::byte*>(from);
    while (size > 0) {
        const ssize_t n = ::send(socket, at, size, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        at += n;
        size -= std::size_t(n);
    }
    return true;
}

bool receive_all(int socket, void* to, std::size_t size) {
    auto* at = static_cast<std::byte*>(to);
    while (size > 0) {
        const ssize_t n = ::recv(socket, at, size, 0);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        at += n;
        size -= std::size_t(n);
    }
    return true;
}

}  // namespace prep::detail
