// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @brief   sums and maxima over a controller's processes, as the core asks for them (private)
 */
#ifndef vtkChiReduction_h
#define vtkChiReduction_h

#include "vtkAlgorithm.h"
#include "vtkCommunicator.h"
#include "vtkExtentTranslator.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cstdint>
#include <vector>

// In place, some at a time: no second array as long as the first.
template <class Wire, class T>
bool vtkChiReduce(vtkMultiProcessController* controller, T* values, size_t count, int operation)
{
  const size_t most = size_t{ 1 } << 16;
  std::vector<Wire> own, all;
  for (size_t begin = 0; begin < count; begin += most)
  {
    const size_t n = std::min(most, count - begin);
    own.assign(values + begin, values + begin + n);
    all.resize(n);
    if (!controller->AllReduce(own.data(), all.data(), static_cast<vtkIdType>(n), operation))
    {
      return false;
    }
    std::copy(all.begin(), all.end(), values + begin);
  }
  return true;
}

inline int vtkChiMaxOfAll(void* user, double* values, size_t count)
{
  return !vtkChiReduce<double>(
    static_cast<vtkMultiProcessController*>(user), values, count, vtkCommunicator::MAX_OP);
}

inline int vtkChiSumOfAll(void* user, std::int64_t* values, size_t count)
{
  return !vtkChiReduce<long long>(
    static_cast<vtkMultiProcessController*>(user), values, count, vtkCommunicator::SUM_OP);
}

inline int vtkChiNumberOfProcesses(vtkMultiProcessController* controller)
{
  return controller ? controller->GetNumberOfProcesses() : 1;
}

// Ask for all of the input, of several processes for this one's piece.
inline void vtkChiRequestPiece(vtkMultiProcessController* controller, vtkInformation* info)
{
  const int processes = vtkChiNumberOfProcesses(controller);
  const int process = processes > 1 ? controller->GetLocalProcessId() : 0;
  if (processes > 1)
  {
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), process);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), processes);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  if (info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    int extent[6];
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
    if (processes > 1 && info->Has(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT()))
    {
      int whole[6];
      std::copy(extent, extent + 6, whole);
      vtkNew<vtkExtentTranslator> translator;
      translator->PieceToExtentThreadSafe(
        process, processes, 0, whole, extent, vtkExtentTranslator::BLOCK_MODE, 0);
    }
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent, 6);
  }
}

#endif
