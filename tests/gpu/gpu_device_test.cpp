#include <gtest/gtest.h>

#include "gpu/device_select.h"
#include "gpu/driver_files.h"

namespace candela::gpu::test {

namespace {
DeviceInfo device(int index, std::string name, std::string type, std::string uuid) {
  DeviceInfo info;
  info.index = index;
  info.name = std::move(name);
  info.is_cpu = type == "cpu";
  info.type = std::move(type);
  info.uuid = std::move(uuid);
  return info;
}
const std::vector<DeviceInfo>& devices() {
  static const std::vector<DeviceInfo> list = {
      device(0, "llvmpipe (LLVM 15)", "cpu", "000102030405060708090a0b0c0d0e0f"),
      device(1, "Modest UHD", "integrated", "100102030405060708090a0b0c0d0e0f"),
      device(2, "Mighty RTX 4090", "discrete", "200102030405060708090a0b0c0d0e0f")};
  return list;
}
int chosen(std::string_view which) {
  const Expected<int> index = choose_device(devices(), which);
  return index ? *index : -1;
}
}  // namespace

TEST(ChooseDevice, TakesTheBestGpuAndTheCpuOnlyWhereThereIsNoOther) {
  EXPECT_EQ(chosen(""), 2);
  EXPECT_EQ(chosen("gpu"), 2);
  EXPECT_EQ(chosen("cpu"), 0);
  EXPECT_EQ(choose_device(std::span(devices()).first(1), "").value_or(-1), 0);
  EXPECT_EQ(choose_device(std::span(devices()).first(2), "gpu").value_or(-1), 1);
}

// Those of CPUs and of other vendors are always asked.
TEST(ChooseDevice, LoadsNoDriverOfAGpuWhereTheKernelHasNone) {
  const std::string without = drivers_without_device("/no/such/folder");
  for (const char* file : {"radeon_icd*", "intel_icd*"}) EXPECT_NE(without.find(file), std::string::npos) << file;
  for (const char* file : {"lvp", "nvidia", "*_icd", "dzn"}) EXPECT_EQ(without.find(file), std::string::npos) << file;
  EXPECT_EQ(drivers_without_device("/"), "");
}

TEST(ChooseDevice, UnderstandsIndexUuidAndPartOfAName) {
  EXPECT_EQ(chosen("1"), 1);
  EXPECT_EQ(chosen("100102030405060708090a0b0c0d0e0f"), 1);
  EXPECT_EQ(chosen("10010203-0405-0607-0809-0A0B0C0D0E0F"), 1);
  EXPECT_EQ(chosen("LLVMpipe"), 0);
  EXPECT_EQ(chosen("4090"), 2);
}

TEST(ChooseDevice, FailsRatherThanFallsBackAndListsWhatThereIs) {
  for (const char* which : {"7", "voodoo", "300102030405060708090a0b0c0d0e0f"}) {
    const Expected<int> index = choose_device(devices(), which);
    ASSERT_FALSE(index) << which;
    EXPECT_EQ(index.error().kind, ErrorKind::device);
    EXPECT_NE(index.error().message.find(which), std::string::npos);
    EXPECT_NE(index.error().message.find("Modest UHD"), std::string::npos);
  }
  EXPECT_FALSE(choose_device(std::span(devices()).first(1), "gpu"));
  EXPECT_FALSE(choose_device({}, ""));
}

TEST(ChooseDevice, SaysWhyADeviceCannotBeUsed) {
  std::vector<DeviceInfo> list = {devices()[0]};
  list[0].unusable = "lacks descriptorIndexing: install a newer one";
  const Expected<int> index = choose_device(list, "");
  ASSERT_FALSE(index);
  EXPECT_NE(index.error().message.find("lacks descriptorIndexing: install a newer one"), std::string::npos);
}

TEST(DeviceFeatures, NamesWhatIsMissing) {
  DeviceFeatures none;
  EXPECT_NE(missing_features(none).find("descriptorIndexing"), std::string::npos);
  DeviceFeatures all;
  enable_features(none, all);
  EXPECT_EQ(missing_features(all), "");
  all.v13.synchronization2 = VK_FALSE;
  EXPECT_EQ(missing_features(all), "synchronization2");
}

TEST(OpenDevice, OpensWhatTheListNamesAndRefusesWhatItDoesNot) {
  const auto list = list_devices();
  ASSERT_TRUE(list) << list.error().text();
  ASSERT_FALSE(list->empty());
  const auto opened = Device::open({.which = list->front().uuid, .validate = true});
  ASSERT_TRUE(opened) << opened.error().text();
  EXPECT_EQ((*opened)->info().name, list->front().name);
  EXPECT_GT((*opened)->info().subgroup_size, 0u);
  EXPECT_TRUE((*opened)->validation_messages().empty());
  EXPECT_FALSE(Device::open({.which = "no such device"}));
}

}  // namespace candela::gpu::test
