// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ChiTestImage_h
#define ChiTestImage_h

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkRenderWindow.h"
#include "vtkWindowToImageFilter.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <sys/stat.h>

// Compares a window with a committed picture: one metric for all versions of VTK (vtkTesting's
// differs).
namespace ChiTestImage
{
// argv[1]: folder of baselines, argv[2]: folder for the pictures of failed comparisons.
// Mean difference <= 1 / 255 and 99 % of the pixels <= 4 / 255: what the project calls "within 1 /
// 255", which rounding to 8 bits and a new version of the software rasteriser stay below.
inline bool Compare(vtkRenderWindow* window, int argc, char* argv[], const std::string& name)
{
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  grab->Update();
  const std::string baseline =
    argc > 1 ? std::string(argv[1]) + "/" + name + ".png" : std::string();
  const std::string written = argc > 2 ? std::string(argv[2]) + "/" + name + ".png" : name + ".png";
  const auto keep = [&grab, &written](const std::string& why)
  {
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(written.c_str());
    writer->SetInputConnection(grab->GetOutputPort());
    writer->Write();
    std::cerr << why << ", the picture is in " << written << "\n";
    return false;
  };
  struct stat unused;
  if (baseline.empty() || stat(baseline.c_str(), &unused) != 0)
  {
    return keep("no baseline " + baseline);
  }
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(baseline.c_str());
  reader->Update();
  vtkDataArray* is = grab->GetOutput()->GetPointData()->GetScalars();
  vtkDataArray* should = reader->GetOutput()->GetPointData()->GetScalars();
  if (!should || is->GetNumberOfTuples() != should->GetNumberOfTuples())
  {
    return keep("the baseline has another size");
  }
  double sum = 0.0;
  vtkIdType far = 0;
  for (vtkIdType i = 0; i < is->GetNumberOfTuples(); ++i)
  {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c)
    {
      largest = std::max(largest, std::abs(is->GetComponent(i, c) - should->GetComponent(i, c)));
    }
    sum += largest;
    far += largest > 4.0 ? 1 : 0;
  }
  const double count = static_cast<double>(is->GetNumberOfTuples());
  const bool good = sum / count <= 1.0 && static_cast<double>(far) / count <= 0.01;
  return good ||
    keep("mean difference " + std::to_string(sum / count) + "/255, " + std::to_string(far) +
      " pixels beyond 4/255");
}
}

#endif
