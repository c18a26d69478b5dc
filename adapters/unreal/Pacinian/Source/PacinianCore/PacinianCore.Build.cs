using System.IO;
using UnrealBuildTool;

/// The wire and the client in C++17, without the engine, exceptions or RTTI; adapters/cpp tests it without the engine.
/// Uses libzmq, for servers on other machines, if the headers of the module ZeroMQ are in place.
public class PacinianCore : ModuleRules
{
    public PacinianCore(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.NoPCHs;
        bUseUnity = false; // files use equal names in anonymous namespaces, and some include windows.h
        bEnableExceptions = false;
        bUseRTTI = false;
        PrivateIncludePaths.Add(Path.Combine(ModuleDirectory, "Private"));
        PrivateDependencyModuleNames.AddRange(new string[] { "Core", "Projects" });
        string Header = Path.Combine(ModuleDirectory, "..", "ThirdParty", "ZeroMQ", "Include", "zmq.h");
        if (File.Exists(Header)) // a dependency that is missing would make UBT write its makefile in each build
        {
            ExternalDependencies.Add(Header);
            PrivateDependencyModuleNames.AddRange(new string[] { "ZeroMQ" });
            PrivateDefinitions.Add("PACINIAN_LIBZMQ=1");
        }
        if (Target.Platform == UnrealTargetPlatform.Win64)
        {
            PublicSystemLibraries.Add("ws2_32.lib");
        }
    }
}
