#pragma once
#include <map>
#include <string>
#include <vector>

#include "report/picture_viewer.h"

namespace candela {

// Two images as `compare` measured them.
struct CompareReport {
  struct Limit {
    std::string metric;
    double measured = 0, limit = 0;
    bool pass = false;
  };
  std::string reference, test;  // files
  std::string program;          // program_text
  std::map<std::string, double> metrics;
  std::vector<Limit> limits;
  ViewedPictures pictures;
};
// A page that needs nothing from outside.
std::string compare_html(const CompareReport& report);

}  // namespace candela
