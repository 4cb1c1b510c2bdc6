#include "base/files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "base/prepared_file.h"
#include "base/process.h"
#include "base/stale_files.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("candela-files-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  std::vector<std::string> temporaries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().string().find(".tmp") != std::string::npos) names.push_back(entry.path().filename().string());
    return names;
  }
  static std::string text_of(const fs::path& file) {
    const auto bytes = read_file(file);
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : bytes.error().text();
  }
  fs::path folder;
};

// The exit code of `work` in a process of its own.
template <class F>
int in_a_child(F&& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST_F(Files, NoFileGetsTheNumberOfAStandardStreamThatCameClosed) {
  const std::string file = (folder / "picture").string();
  for (const int closed : {1, 2, 4, 5, 6, 7})
    EXPECT_EQ(in_a_child([&] {
                for (int stream = 0; stream <= 2; ++stream)
                  if (closed >> stream & 1) close(stream);
                if (!prepare_process()) return 100;
                const int opened = open(file.c_str(), O_WRONLY | O_CREAT, 0600);
                char byte = 0;
                for (int stream = 0; stream <= 2; ++stream)  // still of no use
                  if (closed >> stream & 1)
                    if ((stream == 0 ? read(stream, &byte, 1) : write(stream, &byte, 1)) != -1 || errno != EBADF)
                      return 101;
                return opened > 2 ? 3 : opened;
              }),
              3)
        << closed;
}

TEST_F(Files, AFileSizeLimitIsAnErrorOfTheOutput) {
  const fs::path file = folder / "large";
  EXPECT_EQ(in_a_child([&] {
              prepare_process();
              const rlimit most{4096, 4096};
              setrlimit(RLIMIT_FSIZE, &most);
              const auto written = write_file_atomically(file, std::string(8192, 'x'));
              return written ? 0 : int(written.error().kind);
            }),
            int(ErrorKind::output));
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(Files, TheLongestLegalNameCanBeWritten) {
  for (const char* ending : {".exr", ".ending-of-forty-characters-which-no-one-has"}) {
    const fs::path file = folder / (std::string(255 - std::string(ending).size(), 'n') + ending);
    const auto written = write_file_atomically(file, std::string_view("whole"));
    ASSERT_TRUE(written) << written.error().text();
    EXPECT_EQ(fs::file_size(file), 5u);
  }
}

TEST_F(Files, TemporariesOfDeadProcessesAreRemovedAndNoOthers) {
  const fs::path target = folder / "film.mp4", other = folder / "other.mp4";
  const auto left_by_a_child = [&](const fs::path& path) {
    EXPECT_EQ(in_a_child([&] {
                const auto file = PreparedFile::create(path);
                _exit(file ? 0 : 1);  // without the destructor
                return 0;
              }),
              0);
  };
  left_by_a_child(target);
  left_by_a_child(other);
  const auto alive = PreparedFile::create(target);
  ASSERT_TRUE(alive);
  std::ofstream(folder / ".candela-notes") << "mine";
  remove_stale_temporaries(std::span(&target, 1));
  size_t left = 0;
  for (const auto& entry : fs::directory_iterator(folder)) left += entry.is_regular_file();
  EXPECT_EQ(left, 3u);  // of the living process, of the other target, and what is no temporary
  remove_stale_temporaries(std::span(&other, 1));
  EXPECT_TRUE(fs::exists(folder / ".candela-notes"));
  EXPECT_EQ(temporaries().size(), 1u);
}

// On a shared folder, process 7 of one container is not process 7 of another.
TEST_F(Files, TemporariesOfOtherMachinesStayForAWeek) {
  const fs::path target = folder / "frame.exr";
  std::string name;  // .candela-TARGET-MACHINE-PROCESS-RANDOM.tmp.exr
  {
    const auto made = PreparedFile::create(target);
    name = temporaries().front();
  }
  const size_t machine = name.find('-', std::string(".candela-").size()) + 1;
  name.replace(machine, 8, name[machine] == '0' ? "11111111" : "00000000");
  const size_t process = machine + 9;
  name.replace(process, name.find('-', process) - process, "999999999");  // of no process here
  std::ofstream(folder / name) << "part";
  const fs::path other = folder / "other.exr";
  for (const int hours : {0, 25}) {  // a clock that is a day ahead makes no new file old
    fs::last_write_time(folder / name, fs::file_time_type::clock::now() - std::chrono::hours(hours));
    remove_stale_temporaries(std::span(&target, 1));
    remove_all_stale_temporaries(folder);
    EXPECT_TRUE(fs::exists(folder / name));
  }
  fs::last_write_time(folder / name, fs::file_time_type::clock::now() - std::chrono::hours(24 * 8));
  remove_stale_temporaries(std::span(&other, 1));
  EXPECT_TRUE(fs::exists(folder / name));
  std::ofstream(folder / "notes") << "mine";
  remove_all_stale_temporaries(folder);
  EXPECT_FALSE(fs::exists(folder / name));
  EXPECT_TRUE(fs::exists(folder / "notes"));
}

// Whoever may write in the folder could guess names that count, and place links to what only we may write.
TEST_F(Files, TemporariesFollowNoLinkThatWasPlantedForThem) {
  const fs::path target = folder / "frame.exr", victim = folder / "victim";
  std::ofstream(victim) << "mine";
  std::string before;
  {
    const auto made = PreparedFile::create(target);
    before = temporaries().front();
  }
  const size_t last = before.find(".tmp"), number = before.rfind('-', last) + 1;
  for (int i = 0; i < 100; ++i) {
    std::string name = before;
    fs::create_symlink(victim, folder / name.replace(number, last - number, std::to_string(i)));
  }
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(write_file_atomically(target, std::string_view("picture")));
  EXPECT_EQ(text_of(victim), "mine");
  EXPECT_EQ(text_of(target), "picture");
  EXPECT_EQ(before.substr(number, last - number).size(), 16u);
  const auto a = PreparedFile::create(folder / "a"), b = PreparedFile::create(folder / "a");
  EXPECT_EQ(temporaries().size(), 102u);
}

TEST_F(Files, AFolderThatIsExchangedForALinkKeepsItsFile) {
  fs::create_directories(folder / "frames");
  fs::create_directories(folder / "victims");
  auto file = PreparedFile::create(folder / "frames/a.exr");
  ASSERT_TRUE(file);
  fs::rename(folder / "frames", folder / "moved");
  fs::create_symlink("victims", folder / "frames");
  const std::string text = "picture";
  ASSERT_TRUE(file->write(std::as_bytes(std::span(text))));
  ASSERT_TRUE(file->flush());
  ASSERT_TRUE(file->put_in_place());
  EXPECT_EQ(text_of(folder / "moved/a.exr"), "picture");
  EXPECT_TRUE(fs::is_empty(folder / "victims"));
}

TEST_F(Files, LinksThatAreTheOutputAreWrittenThrough) {
  fs::create_directories(folder / "there");
  fs::create_symlink("there/old", folder / "to-old");
  fs::create_symlink("there/new", folder / "to-new");
  std::ofstream(folder / "there/old") << "before";
  for (const char* name : {"old", "new"}) {
    const auto written = write_file_atomically(folder / (std::string("to-") + name), std::string_view("after"));
    ASSERT_TRUE(written) << written.error().text();
    EXPECT_TRUE(fs::is_symlink(folder / (std::string("to-") + name)));
    EXPECT_EQ(text_of(folder / "there" / name), "after");
  }
  const std::string text = "mine";
  ASSERT_TRUE(replace_file_atomically(folder / "to-old", std::as_bytes(std::span(text))));
  EXPECT_FALSE(fs::is_symlink(folder / "to-old")) << "the program chose this name";
  EXPECT_EQ(text_of(folder / "there/old"), "after");
  fs::create_symlink("loop", folder / "loop");
  for (const fs::path& no_file : {folder / "loop", fs::path("/dev/null"), fs::path("/proc/self/cwd"), folder / "there"})
    EXPECT_FALSE(write_file_atomically(no_file, std::string_view("x"))) << no_file;
  const int unnamed = open((folder / "gone").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  fs::remove(folder / "gone");
  EXPECT_FALSE(write_file_atomically(fmt::format("/proc/self/fd/{}", unnamed), std::string_view("x")));
  close(unnamed);
  EXPECT_EQ(temporaries().size(), 0u);
}

}  // namespace
}  // namespace candela
