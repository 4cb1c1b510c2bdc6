#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace candela {

// Text that others wrote, in lines of ours: control characters, line ends and what turns the direction of text are
// escaped ("\n", "\x1b", "\u202e"), as are bytes that are no UTF-8. The rest is as it was.
std::string printable(std::string_view text);

// A name from a file, in a message: 'name', printable, its quotes and backslashes escaped, and cut after 80 characters.
std::string quoted_name(std::string_view name);

// A name from a file, as a part of a file's name: letters, digits, ".", "_", "-" and what is no ASCII stay, anything
// else becomes "_", and it begins with none of ".-". Never empty, at most 80 bytes: of longer ones the end gives way to
// a hash of the name.
std::string file_name_part(std::string_view name);
// Parts of file names that differ from each other whatever the names are, also where case does not count: those that
// would not are numbered.
std::vector<std::string> file_name_parts(const std::vector<std::string>& names);

}  // namespace candela
