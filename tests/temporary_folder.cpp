// Linked into every test program: what it leaves in the folder of temporary files is removed at its end, also by the
// programs that it starts. GoogleTest's TempDir() follows TEST_TMPDIR, std::filesystem and candela TMPDIR.
#include <stdlib.h>

#include <filesystem>
#include <string>

namespace candela::test {
namespace {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code failed;
    std::string made = (std::filesystem::temp_directory_path(failed) / "candela-test-XXXXXX").string();
    if (failed || !mkdtemp(made.data())) return;  // tests will say what is wrong with the folder there is
    path_ = made;
    setenv("TEST_TMPDIR", path_.c_str(), 1);
    setenv("TMPDIR", path_.c_str(), 1);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

 private:
  std::string path_;
};

const TemporaryFolder temporary_folder;

}  // namespace
}  // namespace candela::test
