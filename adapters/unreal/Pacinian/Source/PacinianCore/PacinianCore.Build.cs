using System.IO;
using UnrealBuildTool;

/// The wire and the client, without the engine: C++17, neither exceptions nor RTTI. Tested outside of it by adapters/cpp.
public class PacinianCore : ModuleRules
{
    public PacinianCore(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.NoPCHs;
        bUseUnity = false; // files have names of their own in anonymous namespaces, and zmq.h includes windows.h
        bEnableExceptions = false;
        bUseRTTI = false;
        PrivateIncludePaths.Add(Path.Combine(ModuleDirectory, "Private"));
        PrivateDependencyModuleNames.AddRange(new string[] { "Core", "Projects", "ZeroMQ", "MsgPack" });
    }
}
