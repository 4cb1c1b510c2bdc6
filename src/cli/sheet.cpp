#include <CLI/CLI.hpp>

#include "base/log.h"
#include "cli/command.h"
#include "cli/input_options.h"
#include "cli/signals.h"
#include "image/io.h"
#include "job/job.h"
#include "metrics/compare.h"
#include "metrics/regions.h"
#include "render/contact_sheet.h"
#include "render/frame_names.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;

struct SheetOptions {
  std::vector<std::string> pictures;
  std::string output, tile = "320x180", crop;
  int columns = 0;
  bool quiet = false;
};

Expected<SheetPicture> picture_of(const std::string& file, const std::optional<Region>& region) {
  auto image = read_image(file);
  if (!image) return std::unexpected(image.error());
  if (region) {
    if (auto good = check_region(*region, image->width, image->height); !good)
      return fail(ErrorKind::usage, "--crop", "{}: {}", file, good.error().message);
    *image = crop(*image, *region);
  }
  SheetPicture picture{display_planes(*image, encoding_of(file)), image->width, image->height,
                       fs::path(file).stem().string()};
  if (picture.planes.size() != 3) return fail(ErrorKind::input, file, "has no colour channels to show");
  if (const Channel* alpha = image->find("A"); alpha && alpha->type != ChannelType::uint32) {
    picture.alpha = alpha->f;
    for (float& a : picture.alpha) a = a > 0 ? std::min(a, 1.0f) : 0.0f;
  }
  return picture;
}

Expected<int> run_sheet(const SheetOptions& o) {
  if (o.quiet) log::set_level(log::Level::warning);
  if (o.pictures.empty()) return fail(ErrorKind::usage, "PICTURE", "no pictures given; name PNG or EXR files");
  if (o.output.empty()) return fail(ErrorKind::usage, "-o", "no output given; name a file that ends in .png");
  if (const auto format = output_format(o.output); !format || *format != OutputFormat::png)
    return fail(ErrorKind::usage, "-o", "'{}' does not end in .png", o.output);
  const auto tile = parse_size(o.tile);
  if (!tile || tile->first < 8 || tile->second < 8 || tile->first > 16384 || tile->second > 16384)
    return fail(ErrorKind::usage, "--tile", "'{}' is not a size from 8x8 to 16384x16384", o.tile);
  std::optional<Region> region;
  if (!o.crop.empty()) {
    const auto read = parse_region(o.crop);
    if (!read) return fail(ErrorKind::usage, "--crop", "{}", read.error().message);
    region = *read;
  }
  if (auto ready = prepare_output(o.output); !ready) return std::unexpected(ready.error());
  std::vector<SheetPicture> pictures;
  const HeldSignals held;
  for (const std::string& file : o.pictures) {
    if (held.pending() != 0) {
      log::warning("interrupted after {} of {} pictures; no sheet was written, the same command begins again",
                   pictures.size(), o.pictures.size());
      return 128 + held.pending();
    }
    auto picture = picture_of(file, region);
    if (!picture) return std::unexpected(picture.error());
    pictures.push_back(std::move(*picture));
  }
  const DisplayImage sheet =
      contact_sheet(pictures, {.columns = o.columns, .tile_width = tile->first, .tile_height = tile->second});
  constexpr int max_side_px = 65535;
  if (sheet.width > max_side_px || sheet.height > max_side_px)
    return fail(ErrorKind::usage, "--tile", "the sheet would be {}x{} pixels; take smaller tiles", sheet.width,
                sheet.height);
  if (auto written = write_png(o.output, sheet); !written) return std::unexpected(written.error());
  log::info("wrote {}: {} pictures, {}x{}", o.output, pictures.size(), sheet.width, sheet.height);
  return 0;
}

}  // namespace

void add_sheet(CLI::App& app, Action& action) {
  auto o = std::make_shared<SheetOptions>();
  CLI::App* command = app.add_subcommand("sheet", "Put pictures side by side into one, with their names");
  command->add_option("pictures", o->pictures, "PNG or EXR files, in this order")->type_name("PICTURE");
  command->add_option("-o,--output", o->output, "File to write")->type_name("FILE.png");
  command->add_option("--columns", o->columns, "Pictures in a row; 0: about as many as rows")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--tile", o->tile, "Size of each picture in pixels; larger ones are made smaller")
      ->capture_default_str()
      ->type_name("WxH");
  command->add_option("--crop", o->crop, "Only this part of each picture, in pixels from the upper left corner")
      ->type_name("X,Y,W,H");
  add_decode_budget(*command);
  command->add_flag("--quiet", o->quiet, "Only warnings and errors on stderr");
  command->callback([o, &action] { action = [o] { return run_sheet(*o); }; });
}

}  // namespace candela::cli
