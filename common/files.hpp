// Whole files: read as text with checks, written whole or not at all.
#pragma once

#include <string>

namespace ukemi {

/// The bytes of a text file, its first `at_most`. Throws InputError on a missing or unreadable file, a folder, NUL or
/// control bytes (with their line and column), and a line longer than `longest_line` bytes.
std::string read_text_file(const std::string& path, std::size_t longest_line = 1 << 20,
                           std::size_t at_most = std::string::npos);

/// The bytes of any file, its first `at_most`. Throws InputError on a missing or unreadable file, or a folder.
std::string read_binary_file(const std::string& path, std::size_t at_most = std::string::npos);

/// Writes `content` under a temporary name beside `path`, then renames it: never a partial file. Makes the folder where
/// it is missing. Throws InputError naming the path and the system's reason.
void write_file(const std::string& path, const std::string& content);

/// Checks, before any work, that a folder can be made and written in; leaves nothing in it. Throws InputError.
void require_writable_folder(const std::string& folder);

/// FNV-1a checksum of a file's bytes, as 16 hexadecimal digits, for provenance.
std::string checksum(const std::string& path);

}  // namespace ukemi
